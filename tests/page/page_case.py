"""What a test of the live page does with it: opens it, reads its numbers, looks at its pixels. For page_test.py."""
import json
import pathlib
import time

import browser
import fake_server
import page_numbers


class PageCase(page_numbers.PageNumbers):
    """Each test has a page of its own; the browser is started once."""

    pictures = None  # folder for screenshots; none: none are kept

    @classmethod
    def setUpClass(cls):
        cls.browser = cls.start()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def setUp(self):
        self.server = None
        self.browser.errors.clear()
        self.browser.size(1600, 1000)

    def tearDown(self):
        self.browser.open("about:blank")
        if self.server:
            self.server.stop()

    def open(self, **options):
        self.server = fake_server.FakeServer(**options)
        self.browser.open(self.server.address)
        self.browser.wait("document.getElementById('title').textContent !== ''")

    def no_errors(self):
        self.browser.evaluate("1")  # so that what was said before it has arrived
        self.assertEqual(self.browser.errors, [])

    def text(self, name):
        return self.browser.evaluate(f"document.getElementById({json.dumps(name)}).textContent")

    def wait_said(self, key, good=bool, seconds=10):
        """Until `good` of all that the page has told the server under this key is true; all that."""
        end = time.monotonic() + seconds
        while not good(said := self.server.said(key)):
            self.assertLess(time.monotonic(), end, f"{key}: {said}")
            time.sleep(0.05)
        return said

    def stage(self):
        return self.browser.evaluate("(({x, y, width, height}) => [x, y, width, height])"
                                     "(document.getElementById('stage').getBoundingClientRect())")

    def middle(self, share=0.4):
        """Of the picture, so far from its top: the organ is there; at 0.24 it is touched."""
        x, y, width, height = self.stage()
        return x + width / 2, y + height * share

    def organ(self, share=0.4):
        """The pixels there."""
        x, y = self.middle(share)
        return [p for row in browser.pixels(self.browser.screenshot((round(x) - 90, round(y) - 90, 180, 180))) for p in row]

    def wait_tissue(self):
        """Until most of the picture's middle has the colour of an organ."""
        end, red = time.monotonic() + 10, 0
        while red < 0.8:
            self.assertLess(time.monotonic(), end, f"{100 * red:.0f} % of the pixels are tissue")
            pixels = self.organ()
            red = sum(r > 1.3 * g for r, g, b in pixels) / len(pixels)

    def picture(self, name):
        if self.pictures:
            pathlib.Path(self.pictures, f"{type(self).__name__}_{name}.png").write_bytes(self.browser.screenshot())
