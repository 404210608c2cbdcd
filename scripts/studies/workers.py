"""Runs the cells of a study, two at a time, and tells how far they are and how long they still take."""

import subprocess
import sys
import threading
import time
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait

AT_ONCE = 2
BAR = 30      # characters
LINES = 10    # over the whole work, where stderr is no terminal


class Failed(Exception):
    """A program failed; the text is for the user."""


def run_program(*arguments):
    """Its output is shown only if it fails."""
    ended = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, check=False)
    if ended.returncode != 0:
        raise Failed(f"{' '.join(map(str, arguments))}\nended with {ended.returncode}:\n{ended.stderr[-2000:]}")


class Workers:
    def __init__(self, name, total):
        """`total`: sum of the weights of all commands to come."""
        self.name, self.total, self.done, self.told = name, total, 0.0, 0
        self.lock, self.begin, self.stopped = threading.Lock(), time.monotonic(), False
        self.terminal = sys.stderr.isatty()

    def command(self, weight, *arguments):
        """Run a program that is worth `weight` of the whole."""
        if self.stopped:
            raise Failed("stopped")
        run_program(*arguments)
        self.advance(weight)

    def advance(self, weight):
        """Something that is worth `weight` of the whole is done."""
        with self.lock:
            self.done += weight
            self.tell()

    def tell(self):
        share = min(1.0, self.done / self.total)
        took = time.monotonic() - self.begin
        left = took / share - took
        text = (f"{self.name}: [{'#' * round(BAR * share):<{BAR}}] {100 * share:3.0f} %, {took / 60:.1f} min, "
                f"{left / 60:.1f} min left")
        if self.terminal:
            print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)
        elif int(LINES * share) >= self.told:
            print(text, file=sys.stderr, flush=True)
            self.told = int(LINES * share) + 1

    def finish(self):
        self.done = self.total
        self.tell()
        if self.terminal:
            print(file=sys.stderr)

    def run(self, work, cells):
        """[work(cell)], in the order of the cells."""
        with ThreadPoolExecutor(AT_ONCE) as pool:
            futures = [pool.submit(work, cell) for cell in cells]
            try:
                ended, _ = wait(futures, return_when=FIRST_EXCEPTION)
                for future in ended:
                    future.result()
            except BaseException:
                self.stopped = True
                pool.shutdown(cancel_futures=True)
                raise
        return [future.result() for future in futures]
