#!/usr/bin/env python3
"""The live page of a real session: sim_server, haptic_client and a browser.

usage: session_test.py FOLDER_OF_PROGRAMS [--browser chromium|firefox] [--pictures FOLDER] [NAME...]
Skipped, with a word, where there is no browser or the programs have no page.
"""
import argparse
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import browser
import page_numbers

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = PICTURES = KIND = None


def free_port(kind):
    with socket.socket(socket.AF_INET, kind) as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Program:
    """One of ours, with what it says in a file."""

    def __init__(self, folder, name, *arguments):
        self.log = pathlib.Path(folder, f"{name}_{time.monotonic_ns()}.log")
        with open(self.log, "wb") as log:
            self.process = subprocess.Popen([PROGRAMS / name, *map(str, arguments)], stdout=log, stderr=log, cwd=ROOT)

    def says(self, pattern, seconds=90):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            match = re.search(pattern, self.log.read_text(errors="replace"))
            if match:
                return match
            if self.process.poll() is not None:
                break
            time.sleep(0.1)
        raise AssertionError(f"never said {pattern}: {self.log.read_text(errors='replace')[-2000:]}")

    def stop(self):
        self.process.terminate()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


class SessionTest(page_numbers.PageNumbers, unittest.TestCase):
    scene, client, device = "liver_paper", "liver_paper", []

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="palpate_page_")
        self.addCleanup(shutil.rmtree, self.folder, True)
        self.udp = free_port(socket.SOCK_DGRAM)
        self.server = self.start("sim_server", "run", f"configs/scenes/{self.scene}.toml", "--listen", f"127.0.0.1:{self.udp}",
                                 "--viewer", free_port(socket.SOCK_STREAM))
        self.address = self.server.says(r"the live page: (http://\S+)").group(1)
        self.server.says("ready after")
        self.hand = self.start_client()
        self.browser = {"chromium": browser.Chromium, "firefox": browser.Firefox}[KIND](browser.find(KIND))
        self.addCleanup(self.browser.close)
        self.browser.size(1600, 1000)
        self.browser.open(self.address)
        self.browser.wait("document.getElementById('status').textContent === 'Live'", 30)

    def start(self, name, *arguments):
        program = Program(self.folder, name, *arguments)
        self.addCleanup(program.stop)
        return program

    def start_client(self):
        return self.start("haptic_client", "run", f"configs/clients/{self.client}.toml", "--server", f"127.0.0.1:{self.udp}",
                          *self.device)

    def place(self):
        return [float(x) for x in self.number("Place x, y, z").replace("\u2212", "-").split()]

    def picture(self, name):
        if PICTURES:
            pathlib.Path(PICTURES, f"session_{name}.png").write_bytes(self.browser.screenshot())

    def no_errors(self):
        self.browser.evaluate("1")
        self.assertEqual(self.browser.errors, [])


class SimulatedHandTest(SessionTest):
    def test_a_hand_presses_and_a_page_pauses_and_steps(self):
        self.wait_number("Held", lambda text: text == "yes")
        self.wait_number("Force computed", lambda text: float(text) > 0.05)
        self.picture("pressed")
        self.browser.key(" ")
        self.browser.wait("document.getElementById('status').textContent === 'Paused'")
        step = int(self.number("Step"))
        time.sleep(0.5)
        self.assertLessEqual(int(self.number("Step")), step + 1)  # one may have been under way
        step = int(self.number("Step"))
        self.browser.key("ArrowRight")
        self.wait_number("Step", lambda text: int(text) == step + 1)
        self.browser.key(" ")
        self.browser.wait("document.getElementById('status').textContent === 'Live'")
        self.wait_number("Step", lambda text: int(text) > step + 20)
        self.no_errors()

    def test_another_scene_is_chosen(self):
        self.wait_number("Held", lambda text: text == "yes")
        self.browser.wait("document.querySelector('#scenes option[value=block_fibres]') !== null")
        self.browser.evaluate("(e => { e.value = 'block_fibres'; e.dispatchEvent(new Event('change')); })"
                              "(document.getElementById('scenes'))")
        self.wait_number("File", lambda text: text.endswith("block_fibres.toml"), 60)
        self.browser.wait("document.getElementById('status').textContent === 'Live'")
        self.wait_number("Step", lambda text: int(text) > 10)
        # While the other scene is set up nobody listens: what a browser writes of a connection refused is no error of ours.
        self.browser.errors = [line for line in self.browser.errors if "/live' failed" not in line]
        self.no_errors()

    def test_a_shared_file_has_the_session_in_it(self):
        self.wait_number("Force computed", lambda text: float(text) > 0.05)
        time.sleep(2)
        title = self.browser.evaluate("document.getElementById('title').textContent")
        self.browser.evaluate("document.getElementById('share').click()")
        file = self.browser.wait_for_file("*.html")
        self.server.stop()
        self.browser.errors.clear()
        self.browser.open(file.as_uri())
        self.browser.wait("document.getElementById('status').textContent === 'Recorded'")
        self.assertEqual(self.browser.evaluate("document.getElementById('title').textContent"), title)
        self.wait_number("Force computed", lambda text: float(text) > 0.05)
        self.no_errors()


class CaptureTest(SessionTest):
    device = ["--seconds", 6, "--record"]

    def start_client(self):
        self.capture = pathlib.Path(self.folder, "session.pcap")
        return self.start("haptic_client", "run", f"configs/clients/{self.client}.toml", "--server", f"127.0.0.1:{self.udp}",
                          *self.device, self.capture)

    def test_a_capture_scrubs(self):
        self.assertEqual(self.hand.process.wait(60), 0)
        viewer = self.start("sim_server", "view", self.capture, "--scene", f"configs/scenes/{self.scene}.toml", "--viewer",
                            free_port(socket.SOCK_STREAM))
        self.browser.open(viewer.says(r"page: (http://\S+?);").group(1))
        self.browser.wait("document.getElementById('status').textContent === 'Recorded'")
        self.browser.wait("Number(document.getElementById('scrubber').max) > 4000")
        self.browser.key(" ")
        seen = {}
        for milliseconds in [1600, 4200, 300, 1600]:
            self.browser.evaluate(f"(e => {{ e.value = {milliseconds}; e.dispatchEvent(new Event('input')); }})"
                                  "(document.getElementById('scrubber'))")
            self.browser.wait(f"document.getElementById('place').textContent.startsWith('0:0{milliseconds / 1000:.1f}')")
            time.sleep(0.4)
            now = (self.number("Step"), self.number("Force computed"), self.number("Place x, y, z"))
            self.assertEqual(seen.setdefault(milliseconds, now), now)  # the same place shows the same
        self.assertEqual(len(set(seen.values())), 3)
        self.assertGreater(max(float(force) for _, force, _ in seen.values()), 0.05)
        self.no_errors()


class BrowserAsDeviceTest(SessionTest):
    device = ["--device", "browser"]

    def test_a_drag_on_the_organ_changes_tool_force_and_plot(self):
        self.wait_number("Device", lambda text: text == "browser")
        before = self.place()
        x, y, width, height = self.browser.evaluate("(({x, y, width, height}) => [x, y, width, height])"
                                                    "(document.getElementById('stage').getBoundingClientRect())")
        middle = (x + width / 2, y + height / 2)
        self.browser.press(*middle)
        time.sleep(2)  # the tool comes
        for _ in range(4):
            self.browser.move(middle[0] + 6, middle[1])
            self.browser.wheel(*middle, -200)
            self.browser.move(*middle)
            time.sleep(0.3)
        self.wait_number("Force computed", lambda text: float(text) > 0.02)
        self.browser.wait("Number(document.getElementById('big-force').textContent) > 0.02")
        self.picture("touched")
        self.browser.release(*middle)
        self.assertGreater(max(abs(a - b) for a, b in zip(before, self.place())), 5)  # mm
        self.browser.key(" ")
        self.browser.wait("document.getElementById('status').textContent === 'Paused'")
        self.browser.wait("Number(document.getElementById('big-force').textContent) === 0")  # what is felt fades
        self.no_errors()


def has_page():
    """Whether the programs can: the server a page, the client a page as its device."""
    said = [subprocess.run([PROGRAMS / name, "run", "--help"], capture_output=True, text=True).stdout
            for name in ["sim_server", "haptic_client"]]
    return "--viewer" in said[0], re.search(r"^\s+browser\s", said[1], re.M) is not None


def main():
    global PROGRAMS, PICTURES, KIND
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--browser", choices=["chromium", "firefox"], default="chromium")
    parser.add_argument("--pictures", metavar="FOLDER")
    parser.add_argument("names", nargs="*", help="parts of the names of tests")
    options = parser.parse_intermixed_args()
    PROGRAMS, PICTURES, KIND = options.programs.resolve(), options.pictures, options.browser
    if PICTURES:
        os.makedirs(PICTURES, exist_ok=True)
    page, device = has_page()
    if not page or not browser.find(KIND):
        print("page: skipped, no browser here (scripts/setup --browsers), or the programs have no page")
        return 0
    cases = [SimulatedHandTest, CaptureTest] + [BrowserAsDeviceTest] * device
    suite = unittest.TestSuite()
    for case in cases:
        for test in unittest.defaultTestLoader.loadTestsFromTestCase(case):
            if not options.names or any(name in test.id() for name in options.names):
                suite.addTest(test)
    return 0 if unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
