"""WebSocket (RFC 6455) of the standard library alone: enough for the tests to drive a browser and to play a server."""
import base64
import hashlib
import os
import socket
import struct
import urllib.parse

GUID = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10


class Closed(Exception):
    """The other side is gone."""


class WebSocket:
    """One connection, over a socket whose handshake is done. A client masks what it sends."""

    def __init__(self, connection, masks):
        self.connection, self.masks, self.rest = connection, masks, b""

    def send(self, data):
        kind, data = (TEXT, data.encode()) if isinstance(data, str) else (BINARY, bytes(data))
        self._frame(kind, data)

    def receive(self):
        """The next message, str or bytes; raises TimeoutError if the socket has a time limit."""
        whole, first = b"", None
        while True:
            start = self._bytes(2)
            last, kind, length = start[0] & 128, start[0] & 15, start[1] & 127
            if length == 126:
                (length,) = struct.unpack(">H", self._bytes(2))
            elif length == 127:
                (length,) = struct.unpack(">Q", self._bytes(8))
            mask = self._bytes(4) if start[1] & 128 else None
            data = self._bytes(length)
            if mask:
                data = apply_mask(data, mask)
            if kind == CLOSE:
                raise Closed(data)
            if kind == PING:
                self._frame(PONG, data)
            if kind >= CLOSE:
                continue
            first = kind or first
            whole += data
            if last:
                return whole.decode() if first == TEXT else whole

    def close(self):
        try:
            self._frame(CLOSE, struct.pack(">H", 1000))
        except OSError:
            pass
        self.connection.close()

    def _frame(self, kind, data):
        length = len(data)
        bit = 128 if self.masks else 0
        if length < 126:
            head = struct.pack("BB", 128 | kind, bit | length)
        elif length < 65536:
            head = struct.pack(">BBH", 128 | kind, bit | 126, length)
        else:
            head = struct.pack(">BBQ", 128 | kind, bit | 127, length)
        if self.masks:
            mask = os.urandom(4)
            head, data = head + mask, apply_mask(data, mask)
        self.connection.sendall(head + data)

    def _bytes(self, count):
        while len(self.rest) < count:
            more = self.connection.recv(65536)
            if not more:
                raise Closed()
            self.rest += more
        out, self.rest = self.rest[:count], self.rest[count:]
        return out


def apply_mask(data, mask):
    length = len(data)
    key = int.from_bytes((mask * (length // 4 + 1))[:length], "big")
    return (int.from_bytes(data, "big") ^ key).to_bytes(length, "big")


def connect(address, timeout=20, protocol=None):
    """A client's connection to ws://HOST:PORT/PATH, as a page's of a subprotocol if one is named."""
    url = urllib.parse.urlparse(address)
    connection = socket.create_connection((url.hostname, url.port), timeout)
    key = base64.b64encode(os.urandom(16)).decode()
    path = (url.path or "/") + (f"?{url.query}" if url.query else "")
    connection.sendall(
        (f"GET {path} HTTP/1.1\r\nHost: {url.hostname}:{url.port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
         f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
         + (f"Sec-WebSocket-Protocol: {protocol}\r\nOrigin: http://{url.hostname}:{url.port}\r\n" if protocol else "") + "\r\n").encode())
    answer = b""
    while b"\r\n\r\n" not in answer:
        more = connection.recv(4096)
        if not more:
            raise Closed("no handshake")
        answer += more
    head, rest = answer.split(b"\r\n\r\n", 1)
    if b" 101 " not in head.split(b"\r\n")[0]:
        raise Closed(head.decode(errors="replace"))
    made = WebSocket(connection, masks=True)
    made.rest = rest
    return made


def accept_key(key):
    """What a server answers to a client's key."""
    return base64.b64encode(hashlib.sha1((key + GUID).encode()).digest()).decode()
