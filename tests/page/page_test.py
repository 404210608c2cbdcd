#!/usr/bin/env python3
"""The live page in real browsers, against a server without a simulation (fake_server.py).

usage: page_test.py [--browser chromium|firefox] [--pictures FOLDER] [NAME...]     (no browser here: says so, and passes)
"""
import argparse
import json
import math
import os
import pathlib
import struct
import sys
import time
import unittest

import browser
import fake_server
import made_session
from page_case import PageCase

LAW_COLOURS = json.loads((pathlib.Path(__file__).resolve().parents[2] / "common/law_colours.json").read_text())
BACK = (math.cos(0.95) * math.cos(0.5), -math.sin(0.95) * math.cos(0.5), math.sin(0.5))  # where the first view looks from

RIGHT = (math.sin(0.95), math.cos(0.95), 0.0)
UP = (-math.cos(0.95) * math.sin(0.5), math.sin(0.95) * math.sin(0.5), math.cos(0.5))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


class PageTest(PageCase):
    # What it shows

    def test_the_organ_is_there_and_moves(self):
        self.open()
        self.browser.wait("document.getElementById('status').textContent === 'Live'")
        self.wait_tissue()
        first, moved = self.organ(0.24), 0
        end = time.monotonic() + 8
        while moved < 3000 and time.monotonic() < end:
            moved = sum(abs(a - b) > 12 for p, q in zip(first, self.organ(0.24)) for a, b in zip(p, q))
        self.assertGreater(moved, 3000)
        self.no_errors()

    def test_numbers_and_plots_are_those_that_were_sent(self):
        self.open()
        self.wait_number("Rate", lambda text: text == "30.0")
        self.assertEqual(self.number("Model"), "made up")
        self.wait_number("Law felt", lambda text: text == "best recent: two tangents")  # of another message than the rate
        self.assertEqual(self.number("Mesh"), "41.0")  # beside the small error of the extrapolation
        self.assertEqual(self.number("Force on the hand"), "45.6")
        self.assertEqual(self.text("error-beside"), "mesh 41.0 % estimated")
        for name, value in [("Extrapolation", "3.20"), ("Outages", "0.40"), ("Fades", "0.90"), ("Limits", "0.00"), ("Worst tick", "61.0"), ("Not settled", "12")]:
            self.assertEqual(self.number(name), value)
        self.assertIn("strain up to 45 %", self.number("Law of the tissue"))
        self.assertIn("a hand can tell", self.number("Beside a hand"))
        self.assertEqual(self.number("Now"), "device lost")
        self.assertEqual(self.number("Peer"), "127.0.0.1:40112")
        self.assertEqual(self.number("Slew limited"), "2")
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('.plot canvas').length"), 5)
        names = self.browser.evaluate("[...document.querySelectorAll('.chip .name')].map(e => e.textContent)")
        self.assertEqual(names, ["constant", "linear time", "two tangents", "felt", "samples"])
        self.browser.wait("Number(document.getElementById('big-force').textContent) > 1")
        self.no_errors()

    def test_each_measure_has_a_legend_and_strain_energy_is_asked_for(self):
        self.open()
        for name, unit in [("stretch", "%"), ("pressure", "kPa"), ("strain_energy", "J/m"), ("displacement", "mm")]:
            self.choose("measures", name)
            self.browser.wait(f"document.getElementById('scale-top').textContent.includes({json.dumps(unit)})")
        self.wait_said("want", lambda said: said[-2:] == [{"field": "strain_energy"}, {"field": None}])
        self.choose("measures", "plain")
        self.browser.wait("document.getElementById('scale').hidden")
        self.no_errors()

    def choose(self, name, value):
        self.browser.evaluate(f"(e => {{ e.value = {json.dumps(value)}; e.dispatchEvent(new Event('change')); }})"
                              f"(document.getElementById({json.dumps(name)}))")

    # Touch

    def press_on_the_organ(self):
        """Where the tool is not, and waits until it has come there: pixels, and where it then is wanted."""
        self.wait_number("Held", lambda text: text == "yes")
        x, y = self.middle(0.5)
        self.browser.press(x, y)
        self.wait_still()
        return x, y, self.server.said("pointer")[-1]["p"]

    def wait_still(self):
        """Until the page wants the tool at one place for a while."""
        end = time.monotonic() + 15
        while time.monotonic() < end:
            time.sleep(0.3)
            last = [message["p"] for message in self.server.said("pointer")[-5:]]
            if len(last) == 5 and all(p == last[0] for p in last):
                return
        self.fail("the page never rests")

    def test_a_drag_on_the_organ_moves_the_tool_in_the_plane_of_the_camera(self):
        self.open()
        before = self.number("Place x, y, z").split()[:2]
        x, y, first = self.press_on_the_organ()
        self.assertAlmostEqual(math.sqrt(dot(first, first)), made_session.RADIUS + made_session.TOOL_RADIUS, delta=0.002)
        self.browser.move(x + 40, y)
        self.browser.move(x + 80, y + 20)
        self.wait_still()
        said = self.server.said("pointer")
        self.browser.release(x + 80, y + 20)
        numbers = [message["number"] for message in said]
        self.assertEqual(numbers, sorted(set(numbers)))
        self.assertEqual({message["tool"] for message in said}, {0})
        way = minus(said[-1]["p"], first)
        self.assertAlmostEqual(dot(way, BACK), 0, delta=1e-4)
        self.assertAlmostEqual(dot(way, RIGHT) / dot(way, UP), 80 / -20, delta=0.1)
        self.assertGreater(dot(way, RIGHT), 0.008)
        self.wait_number("Place x, y, z", lambda text: text.split()[:2] != before)
        self.no_errors()

    def test_a_tool_goes_over_the_organ_and_not_through_it(self):
        self.open()
        self.wait_number("Held", lambda text: text == "yes")
        x, y, last = self.press_on_the_organ()
        self.browser.release(x, y)
        nearest = min(math.sqrt(dot(message["p"], message["p"])) for message in self.server.said("pointer")[1:])
        self.assertGreater(nearest, made_session.RADIUS - made_session.DEPTH)
        highest = max(dot(message["p"], BACK) for message in self.server.said("pointer"))
        self.assertGreater(highest, dot(last, BACK) + 0.005)
        self.no_errors()

    def test_the_wheel_is_depth_while_touching(self):
        self.open()
        x, y, first = self.press_on_the_organ()
        self.browser.wheel(x, y, -300)
        self.wait_still()
        way = minus(self.server.said("pointer")[-1]["p"], first)
        self.browser.release(x, y)
        deep = -dot(way, BACK)
        self.assertGreater(deep, 0.002)
        self.assertAlmostEqual(math.sqrt(dot(way, way)), deep, delta=1e-5)
        self.no_errors()

    def test_a_page_without_control_turns_and_never_touches(self):
        self.open(control=False)
        self.wait_number("Held", lambda text: text == "yes")
        before = self.organ()
        x, y = self.middle()
        self.browser.drag([(x, y), (x + 90, y + 90)])
        time.sleep(0.3)
        self.assertEqual(self.server.said("pointer"), [])
        self.assertNotEqual(before, self.organ())
        self.assertTrue(self.browser.evaluate("document.getElementById('pause').disabled"))
        self.assertTrue(self.browser.evaluate("document.getElementById('scenes-label').hidden"))
        self.no_errors()

    # Keys

    def test_space_pauses_and_an_arrow_steps(self):
        self.open()
        self.wait_number("Held", lambda text: text == "yes")
        self.browser.key(" ")
        self.browser.wait("document.getElementById('status').textContent === 'Paused'")
        self.wait_number("Force computed", lambda text: text == "0.00")
        step = int(self.number("Step"))
        self.browser.key("ArrowRight")
        self.wait_number("Step", lambda text: int(text) == step + 1)
        self.browser.key(" ")
        self.browser.wait("document.getElementById('status').textContent === 'Live'")
        self.wait_said("pause", lambda said: said == [True, False])
        self.assertEqual(self.wait_said("step"), [1])
        self.no_errors()

    def test_tab_goes_through_the_drawings_and_escape_lets_go(self):
        self.open()
        self.browser.evaluate("document.getElementById('picture-canvas').focus()")
        seen = []
        for _ in range(4):
            seen.append(self.browser.evaluate("document.getElementById('looks').value"))
            self.browser.key("Tab")
        self.assertEqual(seen, ["surface", "edges", "regions", "glass"])
        self.assertEqual(self.browser.evaluate("document.activeElement.id"), "picture-canvas")
        self.browser.key("Escape")
        self.browser.key("Tab")
        self.assertNotEqual(self.browser.evaluate("document.activeElement.id"), "picture-canvas")
        self.no_errors()

    def test_h_shows_the_keys(self):
        self.open()
        self.browser.key("h")
        self.browser.wait("document.getElementById('keys').open")
        self.picture("keys")
        self.browser.key("Escape")
        self.browser.wait("!document.getElementById('keys').open")
        self.no_errors()

    # Another scene, another connection

    def test_a_scene_is_chosen(self):
        self.open()
        self.browser.wait("!document.getElementById('scenes-label').hidden")
        self.choose("scenes", "liver_breathing")
        self.assertEqual(self.wait_said("choose"), ["liver_breathing"])
        self.assertEqual(self.wait_said("hello")[0], {"token": "abc"})
        self.wait_said("shown")
        self.no_errors()

    def test_it_connects_again_by_itself(self):
        self.open()
        self.browser.wait("document.getElementById('status').textContent === 'Live'")
        self.server.drop_pages()
        self.browser.wait("document.getElementById('status').textContent.startsWith('No server')")
        self.browser.wait("document.getElementById('status').textContent === 'Live'")
        self.wait_said("hello", lambda said: len(said) == 2)

    # Recordings

    def test_a_recorded_session_scrubs(self):
        self.open(recorded=made_session.recorded(4))
        self.browser.wait("document.getElementById('status').textContent === 'Recorded'")
        self.browser.wait("!document.getElementById('playback').hidden")
        self.browser.key(" ")
        for milliseconds in [3000, 500, 1700]:
            self.browser.evaluate(f"(e => {{ e.value = {milliseconds}; e.dispatchEvent(new Event('input')); }})"
                                  "(document.getElementById('scrubber'))")
            step = milliseconds * made_session.RATE // 1000
            self.wait_number("Step", lambda text: int(text) == step)
            force = made_session.MadeSession(0).force(step / made_session.RATE) * math.sqrt(1.01)
            self.wait_number("Force computed", lambda text: abs(float(text) - force) < 0.006)
        self.browser.key("ArrowRight")
        self.wait_number("Step", lambda text: int(text) == 52)
        self.browser.key("ArrowLeft")
        self.wait_number("Step", lambda text: int(text) == 51)
        self.assertEqual(self.browser.evaluate("document.getElementById('place').textContent"), "0:01.7 of 0:04.0")
        self.picture("recorded")
        self.no_errors()

    def test_a_shared_file_opens_from_the_disk_without_a_server(self):
        self.open()
        self.wait_number("Step", lambda text: text.isdigit() and int(text) > 60)
        self.browser.evaluate("document.getElementById('share').click()")
        file = self.browser.wait_for_file("a_ball*.html")
        self.assertLess(file.stat().st_size, 4e6)
        self.server.stop()
        self.server = None
        self.browser.errors.clear()
        self.browser.open(file.as_uri())
        self.browser.wait("document.getElementById('status').textContent === 'Recorded'")
        self.browser.wait("Number(document.getElementById('scrubber').max) > 1000")
        self.wait_number("Model", lambda text: text == "made up")
        time.sleep(0.3)
        self.wait_tissue()
        self.assertEqual(self.browser.evaluate("performance.getEntriesByType('resource').length"), 0)
        self.no_errors()

    def test_a_picture_and_a_video_are_saved(self):
        self.open()
        self.wait_number("Held", lambda text: text == "yes")
        self.browser.evaluate("document.getElementById('picture').click()")
        picture = self.browser.wait_for_file("a_ball*.png")
        stage = [round(x * self.browser.evaluate("Math.min(2, devicePixelRatio)")) for x in self.stage()[2:]]
        self.assertEqual(list(struct.unpack(">II", picture.read_bytes()[16:24])), stage)
        self.browser.evaluate("document.getElementById('video').click()")
        self.browser.wait("document.getElementById('video').getAttribute('aria-pressed') === 'true'")
        time.sleep(1.5)
        self.browser.evaluate("document.getElementById('video').click()")
        video = self.browser.wait_for_file("a_ball*.webm")
        self.assertEqual(video.read_bytes()[:4], b"\x1a\x45\xdf\xa3")  # EBML, which WebM is
        self.assertGreater(video.stat().st_size, 2000)
        self.no_errors()

    # How it looks

    def test_it_fits_small_and_large_screens(self):
        self.open()
        for width, height in [(390, 844), (768, 1024), (1600, 1000), (2560, 1440)]:
            self.browser.size(width, height)
            self.browser.wait(f"innerWidth === {width}")
            time.sleep(1.2)
            self.picture(f"{width}")
            wide = self.browser.evaluate("document.documentElement.scrollWidth")
            self.assertLessEqual(wide, width)
            _, _, stage_width, stage_height = self.stage()
            self.assertGreater(stage_width, 0.6 * width if width > 820 else 0.95 * width)
            self.assertGreater(stage_height, 300)
        self.no_errors()

    def test_words_stand_out_from_what_is_behind_them(self):
        """WCAG AA: 4.5 to 1 for text, 3 to 1 for lines."""
        self.open()
        themes = ["dark", "light"] if hasattr(self.browser, "prefer") else [None]
        for theme in themes:
            if theme:
                self.browser.prefer(prefers_color_scheme=theme)
            names = ["--bg", "--raised", "--scene", "--ink", "--muted", "--accent", "--good", "--warn", "--bad", "--sample",
                     "--force"]
            colours = self.browser.evaluate(f"(s => {json.dumps(names)}.map(n => s.getPropertyValue(n).trim()))"
                                            "(getComputedStyle(document.documentElement))")
            colour = dict(zip(names, colours))
            for behind in ["--bg", "--raised", "--scene"]:
                for name in ["--ink", "--muted", "--good", "--warn", "--bad", "--accent"]:
                    self.assertGreaterEqual(contrast(colour[name], colour[behind]), 4.5, f"{theme}: {name} on {behind}")
            prefers_light = self.browser.evaluate("matchMedia('(prefers-color-scheme: light)').matches")
            for law, row in LAW_COLOURS.items():
                self.assertGreaterEqual(contrast(row["light" if prefers_light else "dark"], colour["--bg"]), 3, f"{theme}: {law}")
            for name in names[9:]:
                self.assertGreaterEqual(contrast(colour[name], colour["--bg"]), 3, f"{theme}: {name}")
        self.no_errors()


def contrast(a, b):
    def light(colour):
        parts = [int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)]
        r, g, b = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
        return 0.2126 * r + 0.7152 * g + 0.0722 * b

    high, low = sorted([light(a), light(b)], reverse=True)
    return (high + 0.05) / (low + 0.05)


class NoWebGlTest:
    def test_without_webgl_it_says_so_and_plots_all_the_same(self):
        one = self.start()
        server = fake_server.FakeServer()
        try:
            one.open(server.address)
            one.wait("document.getElementById('no-picture').offsetHeight > 0")
            one.wait("Number(document.getElementById('big-force').textContent) > 1")
            self.assertIn("WebGL", one.evaluate("document.getElementById('no-picture').textContent"))
            self.assertEqual(one.evaluate("document.querySelectorAll('.plot canvas').length"), 5)
            self.assertEqual(one.errors, [])
        finally:
            one.close()
            server.stop()


def cases(kinds):
    classes = {"chromium": browser.Chromium, "firefox": browser.Firefox}
    for kind in kinds:
        program = browser.find(kind)
        if not program:
            print(f"page: no {kind} here")
            continue
        start = classes[kind]
        made = {"start": classmethod(lambda cls, start=start, program=program: start(program))}
        if kind == "chromium" or browser.shutil.which("Xvfb"):
            yield type(kind.capitalize(), (PageTest, unittest.TestCase), made)
        else:
            print("page: firefox draws nothing without Xvfb; only the page without WebGL is tested")
        bare = {"start": classmethod(lambda cls, start=start, program=program: start(program, webgl=False))}
        yield type(f"{kind.capitalize()}WithoutWebGl", (NoWebGlTest, unittest.TestCase), bare)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--browser", choices=["chromium", "firefox"])
    parser.add_argument("--pictures", metavar="FOLDER")
    parser.add_argument("names", nargs="*", help="parts of the names of tests")
    options = parser.parse_intermixed_args()
    PageCase.pictures = options.pictures
    if options.pictures:
        os.makedirs(options.pictures, exist_ok=True)
    suite = unittest.TestSuite()
    for case in cases([options.browser] if options.browser else ["chromium", "firefox"]):
        for test in unittest.defaultTestLoader.loadTestsFromTestCase(case):
            if not options.names or any(name in test.id() for name in options.names):
                suite.addTest(test)
    if suite.countTestCases() == 0:
        print("page: skipped, no browser here (scripts/setup --browsers)")
        return 0
    return 0 if unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
