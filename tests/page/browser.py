"""A headless browser under a test: Chromium by its DevTools protocol, Firefox by WebDriver BiDi. Standard library only."""
import base64
import json
import os
import pathlib
import re
import shutil
import struct
import subprocess
import tempfile
import time
import urllib.request
import zlib

import websocket

CHROMIUM = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu",
            "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
            "--disable-sync", "--hide-scrollbars", "--remote-debugging-port=0"]
FIREFOX = {"webgl.force-enabled": True, "datareporting.policy.dataSubmissionEnabled": False, "app.update.enabled": False,
           "toolkit.telemetry.enabled": False, "browser.shell.checkDefaultBrowser": False,
           "browser.startup.homepage_override.mstone": "ignore", "network.captive-portal-service.enabled": False,
           "network.connectivity-service.enabled": False, "security.fileuri.strict_origin_policy": True}


class BrowserError(Exception):
    pass


def pixels(png):
    """Rows of (r, g, b) of a PNG as browsers write them: 8 bits, not interlaced."""
    at, data = 8, b""
    while at < len(png):
        (length,), kind = struct.unpack(">I", png[at:at + 4]), png[at + 4:at + 8]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", png[at + 8:at + 18])
            assert depth == 8 and colour in (2, 6), "not a picture that this reads"
        if kind == b"IDAT":
            data += png[at + 8:at + 8 + length]
        at += 12 + length
    data, size = zlib.decompress(data), 3 if colour == 2 else 4
    rows, above = [], bytes(width * size)
    for y in range(height):
        start = y * (width * size + 1)
        above = unfiltered(data[start], bytearray(data[start + 1:start + 1 + width * size]), above, size)
        rows.append([tuple(above[x:x + 3]) for x in range(0, width * size, size)])
    return rows


def unfiltered(kind, row, above, size):
    for i in range(len(row)):
        a, b = (row[i - size] if i >= size else 0), above[i]
        c = above[i - size] if i >= size else 0
        if kind == 1:
            row[i] = (row[i] + a) & 255
        elif kind == 2:
            row[i] = (row[i] + b) & 255
        elif kind == 3:
            row[i] = (row[i] + (a + b) // 2) & 255
        elif kind == 4:
            p = a + b - c
            nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            row[i] = (row[i] + nearest) & 255
    return row


def find(kind):
    """The program, or None."""
    names = {"chromium": ["chromium", "chromium-browser", "google-chrome"], "firefox": ["firefox-esr", "firefox"]}[kind]
    return next((path for path in map(shutil.which, names) if path), None)


class Screen:
    """A display that nobody sees."""

    def __init__(self):
        reader, writer = os.pipe()
        self.process = subprocess.Popen(["Xvfb", "-displayfd", str(writer), "-screen", "0", "1700x1200x24", "-nolisten", "tcp"],
                                        pass_fds=[writer], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(writer)
        with os.fdopen(reader) as numbers:
            self.name = ":" + numbers.readline().strip()

    def close(self):
        self.process.terminate()
        self.process.wait()


class Browser:
    """What both can do. Places are CSS pixels of the page."""

    def __init__(self, program, arguments, extra_environment=None):
        self.folder = tempfile.mkdtemp(prefix="palpate_browser_")
        self.log = open(os.path.join(self.folder, "log"), "w+b")
        self.process = subprocess.Popen([program, *arguments(self.folder)], stdout=self.log, stderr=self.log,
                                        env={**os.environ, "HOME": self.folder, **(extra_environment or {})})
        self.errors = []  # console errors and uncaught exceptions
        self.number = 0
        self.socket = None

    def close(self):
        if self.socket:
            self.socket.close()
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.log.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def wait(self, script, seconds=15):
        """Until the script's value is true; the value."""
        end = time.monotonic() + seconds
        while True:
            value = self.evaluate(script)
            if value:
                return value
            if time.monotonic() > end:
                raise BrowserError(f"still not true after {seconds} s: {script}")
            time.sleep(0.05)

    def drag(self, places):
        """Presses at the first place, moves through the others, lets go."""
        self.press(*places[0])
        for place in places[1:]:
            self.move(*place)
            time.sleep(0.15)
        self.release(*places[-1])

    def wait_for_file(self, pattern, seconds=30):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            for file in pathlib.Path(self.folder).glob(pattern):
                unfinished = list(file.parent.glob("*.crdownload")) + list(file.parent.glob("*.part"))
                if not unfinished and file.stat().st_size > 0:  # Firefox names the file before it fills it
                    return file
            time.sleep(0.1)
        raise BrowserError(f"no file {pattern} after {seconds} s")

    def found_in_log(self, pattern, seconds=30):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            text = pathlib.Path(self.folder, "log").read_text(errors="replace")
            match = re.search(pattern, text)
            if match:
                return match.group(1)
            if self.process.poll() is not None:
                break
            time.sleep(0.05)
        raise BrowserError("the browser did not start: " + pathlib.Path(self.folder, "log").read_text(errors="replace")[-2000:])

    def call(self, method, **parameters):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": parameters}))
        while True:
            answer = json.loads(self.socket.receive())
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise BrowserError(f"{method}: {answer['error']} {answer.get('message', '')}")
                return answer["result"]
            self.event(answer)

    def event(self, message):
        raise NotImplementedError


class Chromium(Browser):
    def __init__(self, program, webgl=True):
        flags = [] if webgl else ["--disable-3d-apis"]
        super().__init__(program, lambda folder: [*CHROMIUM, *flags, f"--user-data-dir={folder}/profile", "about:blank"])
        port = self.found_in_log(r"DevTools listening on ws://127\.0\.0\.1:(\d+)/")
        for _ in range(100):
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json/list", timeout=10) as answer:
                pages = [page for page in json.load(answer) if page["type"] == "page"]
            if pages:
                break
            time.sleep(0.1)
        self.socket = websocket.connect(pages[0]["webSocketDebuggerUrl"], timeout=60)
        for domain in ["Page", "Runtime", "Log"]:
            self.call(f"{domain}.enable")
        self.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=self.folder)

    def event(self, message):
        kind, parameters = message.get("method"), message.get("params", {})
        if kind == "Runtime.exceptionThrown":
            self.errors.append(str(parameters["exceptionDetails"].get("exception", {}).get("description")))
        if kind == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "assert"):
            self.errors.append(str([a.get("value", a.get("description")) for a in parameters["args"]]))
        if kind == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            self.errors.append(parameters["entry"]["text"])

    def open(self, address):
        self.call("Page.navigate", url="about:blank")
        self.call("Page.navigate", url=address)
        if address != "about:blank":
            self.wait("document.readyState === 'complete' && location.href !== 'about:blank'")

    def evaluate(self, script):
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise BrowserError(str(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def size(self, width, height, scale=1):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=width < 500)

    def prefer(self, **features):
        """Media features, such as prefers_color_scheme="light"."""
        pairs = [{"name": name.replace("_", "-"), "value": value} for name, value in features.items()]
        self.call("Emulation.setEmulatedMedia", features=pairs)

    def screenshot(self, box=None):
        """PNG; of a box (x, y, width, height), or of all that one sees."""
        clip = {"clip": {**dict(zip(["x", "y", "width", "height"], box)), "scale": 1}} if box else {}
        return base64.b64decode(self.call("Page.captureScreenshot", format="png", **clip)["data"])

    def press(self, x, y):
        self.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)

    def move(self, x, y):
        self.mouse("mouseMoved", x, y, button="left", buttons=1)

    def wheel(self, x, y, pixels):
        self.mouse("mouseWheel", x, y, deltaX=0, deltaY=pixels)

    def release(self, x, y):
        self.mouse("mouseReleased", x, y, button="left", buttons=0, clickCount=1)

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def key(self, key):
        text = {"text": key} if len(key) == 1 else {}
        codes = {"Tab": 9, "ArrowRight": 39, "ArrowLeft": 37, "Escape": 27, " ": 32}
        more = {"windowsVirtualKeyCode": codes[key]} if key in codes else {}
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, **text, **more)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key, **more)


class Firefox(Browser):
    """Headless it has no WebGL on a machine without a graphics card; on the screen of Xvfb it has."""

    def __init__(self, program, webgl=True):
        self.screen = Screen() if webgl and shutil.which("Xvfb") else None

        def arguments(folder):
            profile = pathlib.Path(folder, "profile")
            profile.mkdir()
            all_of_them = {**FIREFOX, "browser.download.folderList": 2, "browser.download.dir": folder,
                           "browser.helperApps.neverAsk.saveToDisk": "text/html,image/png,video/webm"}
            lines = [f"user_pref({json.dumps(name)}, {json.dumps(value)});" for name, value in all_of_them.items()]
            (profile / "user.js").write_text("\n".join(lines))
            headless = [] if self.screen else ["--headless"]
            return [*headless, "--no-remote", "--remote-debugging-port", "0", "--profile", str(profile)]

        super().__init__(program, arguments, {"DISPLAY": self.screen.name} if self.screen else {})
        address = self.found_in_log(r"WebDriver BiDi listening on (ws://\S+)", 60)
        self.socket = websocket.connect(address + "/session", timeout=60)
        self.call("session.new", capabilities={})
        self.page = self.call("browsingContext.getTree")["contexts"][0]["context"]
        self.call("session.subscribe", events=["log.entryAdded"])

    def event(self, message):
        if message.get("method") == "log.entryAdded" and message["params"]["level"] == "error":
            self.errors.append(str(message["params"].get("text")))

    def open(self, address):
        self.call("browsingContext.navigate", context=self.page, url=address, wait="complete")

    def evaluate(self, script):
        answer = self.call("script.evaluate", expression=f"(async () => JSON.stringify((await ({script})) ?? null))()",
                           target={"context": self.page}, awaitPromise=True)
        if answer["type"] == "exception":
            raise BrowserError(answer["exceptionDetails"]["text"])
        return json.loads(answer["result"]["value"])

    def size(self, width, height, scale=1):
        self.call("browsingContext.setViewport", context=self.page, viewport={"width": width, "height": height},
                  devicePixelRatio=scale)

    def screenshot(self, box=None):
        clip = {"clip": {"type": "box", **dict(zip(["x", "y", "width", "height"], box))}} if box else {}
        return base64.b64decode(self.call("browsingContext.captureScreenshot", context=self.page, **clip)["data"])

    def close(self):
        super().close()
        if self.screen:
            self.screen.close()

    def press(self, x, y):
        self.act("mouse", "pointer", [{"type": "pointerMove", "x": round(x), "y": round(y)}, {"type": "pointerDown", "button": 0}])

    def move(self, x, y):
        self.act("mouse", "pointer", [{"type": "pointerMove", "x": round(x), "y": round(y)}])

    def wheel(self, x, y, pixels):
        self.act("wheel", "wheel", [{"type": "scroll", "x": round(x), "y": round(y), "deltaX": 0, "deltaY": round(pixels)}])

    def release(self, x, y):
        self.act("mouse", "pointer", [{"type": "pointerUp", "button": 0}])

    def key(self, key):
        value = {"Tab": "\ue004", "ArrowRight": "\ue014", "ArrowLeft": "\ue012", "Escape": "\ue00c"}.get(key, key)
        self.act("keys", "key", [{"type": "keyDown", "value": value}, {"type": "keyUp", "value": value}])

    def act(self, name, kind, actions):
        source = {"type": kind, "id": name, "actions": actions}
        self.call("input.performActions", context=self.page, actions=[source])
