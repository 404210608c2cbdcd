#!/usr/bin/env python3
"""A server of the page without a simulation: dist/, and the session of made_session.py over /live and /session. It keeps
what pages say, for the tests.

usage: fake_server.py [PORT [recorded]]      (by hand: open the address that it prints)
"""
import http.server
import json
import pathlib
import socket
import socketserver
import sys
import threading
import time

import made_session
import websocket

DIST = pathlib.Path(__file__).resolve().parents[2] / "sim_server/viewer/page/dist"
KINDS = {".html": "text/html; charset=utf-8", ".js": "text/javascript", ".css": "text/css"}
POLICY = ("default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; media-src blob:; "
          "connect-src 'self'")


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def do_GET(self):
        path = self.path.split("?")[0]
        if path == "/live":
            return self.live()
        if path == "/session":
            return self.answer("application/octet-stream", self.server.session)
        file = DIST / ("index.html" if path == "/" else path.lstrip("/"))
        if file.parent != DIST or not file.is_file():
            return self.send_error(404)
        return self.answer(KINDS[file.suffix], file.read_bytes())

    def answer(self, kind, data):
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(data)))
        self.send_header("Content-Security-Policy", POLICY)
        self.end_headers()
        self.wfile.write(data)

    def live(self):
        self.close_connection = True
        self.send_response(101)
        self.send_header("Upgrade", "websocket")
        self.send_header("Connection", "Upgrade")
        self.send_header("Sec-WebSocket-Accept", websocket.accept_key(self.headers["Sec-WebSocket-Key"]))
        self.send_header("Sec-WebSocket-Protocol", "palpate-view-1")
        self.end_headers()
        self.wfile.flush()
        page = websocket.WebSocket(self.connection, masks=False)
        self.server.pages.append(page)
        try:
            threading.Thread(target=self.listen, args=[page], daemon=True).start()
            self.play(page)
        except (OSError, websocket.Closed):
            pass

    def listen(self, page):
        try:
            while True:
                self.server.hear(json.loads(page.receive()))
        except (OSError, websocket.Closed):
            pass

    def play(self, page):
        server = self.server
        page.send(server.made.scene(control=server.control, recorded=server.session is not None))
        if server.session is not None:
            return
        page.send(server.made.topology())
        page.send(server.made.surface(server.number / made_session.RATE))
        last = -1
        while not server.stopped:
            time.sleep(0.01)
            if server.number == last and not server.paused:
                continue
            last = server.number
            for _, message in server.made.step(last, field=server.field, paused=server.paused):
                page.send(message)
            if server.paused:
                time.sleep(0.1)


class FakeServer(socketserver.ThreadingMixIn, http.server.HTTPServer):
    daemon_threads = True
    allow_reuse_address = True

    def __init__(self, port=0, recorded=None, control=True):
        super().__init__(("127.0.0.1", port), Handler)
        self.made = made_session.MadeSession()
        self.session, self.control = recorded, control
        self.heard, self.pages = [], []
        self.number, self.paused, self.field, self.stopped = 0, False, False, False
        threading.Thread(target=self.serve_forever, daemon=True).start()
        threading.Thread(target=self.tick, daemon=True).start()

    @property
    def address(self):
        return f"http://127.0.0.1:{self.server_address[1]}/#token=abc"

    def tick(self):
        while not self.stopped:
            time.sleep(1 / made_session.RATE)
            self.number += not self.paused

    def hear(self, message):
        self.heard.append(message)
        if "pause" in message:
            self.paused = message["pause"]
        if "step" in message:
            self.number += 1
        if "want" in message:
            self.field = message["want"]["field"] is not None
        if "pointer" in message:
            x, y, z = message["pointer"]["p"]
            self.made.shift = (x, y, 0.0)

    def said(self, key):
        return [message[key] for message in list(self.heard) if key in message]

    def drop_pages(self):
        """As if the network went."""
        for page in self.pages:
            try:
                page.connection.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
        self.pages.clear()

    def stop(self):
        self.stopped = True
        self.drop_pages()
        self.shutdown()
        self.server_close()


if __name__ == "__main__":
    session = made_session.recorded() if "recorded" in sys.argv else None
    fake = FakeServer(int(sys.argv[1]) if len(sys.argv) > 1 else 0, session)
    print(fake.address, flush=True)
    try:
        threading.Event().wait()
    except KeyboardInterrupt:
        fake.stop()
