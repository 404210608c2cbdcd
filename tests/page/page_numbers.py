"""The list of numbers that the live page shows, read and waited for. For page_case.py and session_test.py."""
import json
import time


class PageNumbers:
    """Wants `self.browser`, and the assertions of a unittest.TestCase."""

    def number(self, name):
        """What stands beside `name`: a dash until the page was told; empty where there is no such row."""
        return self.browser.evaluate(
            "[...document.querySelectorAll('#numbers dt')].filter(d => d.textContent === " + json.dumps(name) +
            ").map(d => d.nextSibling.firstChild.textContent)[0] ?? ''")

    def wait_number(self, name, good, seconds=30):
        """Until `good` of what stands there is true; a ValueError, as of int() of a dash, counts as not yet."""
        end = time.monotonic() + seconds
        while True:
            text = self.number(name)
            try:
                if good(text):
                    return text
            except ValueError:
                pass
            self.assertLess(time.monotonic(), end, f"{name}: {text}")
            time.sleep(0.03)
