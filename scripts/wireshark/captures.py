"""Palpate's datagrams and pcap files, as `make_captures` writes them and `check` reads them: struct, hashlib, and
nothing of the dissector. The bytes: protocol/README.md."""
import collections
import hashlib
import struct

HEADER = "<4sBBHB3sQQ"  # magic, version, type, payload, tag, reserved (the first is the key), session, sequence
HELLO, CHALLENGE, WELCOME, REFUSE, BYE, TOOL_STATE, FORCE_SAMPLE = 1, 2, 3, 4, 5, 6, 7
TELEMETRY, POINTER, SURFACE_PAGE = 8, 9, 10
TOOL_STATE_FORMAT = "<BQQq3d3d4dHH"  # tool, tick, newest sample, t, p, v, q, buttons, flags
FORCE_SAMPLE_FORMAT = "<BQQq3d3d3dqI"  # tool, number, tool tick, tool t, p, f, torque, step, flags
CLIENT, SERVER = ("192.0.2.1", 45131), ("192.0.2.2", 45130)
TAG = 16
PCAP_NS, RAW_IP, SNAP = 0xA1B23C4D, 101, 65535

Header = collections.namedtuple("Header", "magic version type payload tag reserved session sequence")
Frame = collections.namedtuple("Frame", "number time source destination datagram")  # time: ns


def header(version, kind, payload, tag, key, session, sequence):
    return struct.pack(HEADER, b"PLPT", version, kind, payload, tag, bytes([key, 0, 0]), session, sequence)


def direction_key(shared, from_client, client_nonce, server_nonce):
    """The key of one direction of a session."""
    label = b"client to server" if from_client else b"server to client"
    text = label.ljust(24, b"\0") + bytes([2]) + client_nonce + server_nonce
    return hashlib.blake2b(text, digest_size=32, key=shared).digest()


def tag_of(datagram, key):
    return hashlib.blake2b(datagram, digest_size=TAG, key=key).digest()


def read_keys(path):
    """Of a key file: the keys by their numbers."""
    lines = [line.split("#")[0].split() for line in path.read_text().splitlines()]
    return {int(words[1]): bytes.fromhex(words[2]) for words in lines if words}


def checksum(data):
    words = data + bytes(len(data) % 2)
    total = sum(struct.unpack(f">{len(words) // 2}H", words))
    while total >> 16:
        total = (total & 0xFFFF) + (total >> 16)
    return ~total & 0xFFFF


def address(text):
    return bytes(int(part) for part in text.split("."))


def in_ip(protocol, source, destination, payload):
    """A packet of IPv4 around a payload."""
    def head(check):
        return struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(payload), 0, 0x4000, 64, protocol, check, address(source),
                           address(destination))
    return head(checksum(head(0))) + payload


def in_udp(source, destination, datagram):
    """A packet of IPv4 and UDP around a datagram."""
    def head(check):
        return struct.pack(">HHHH", source[1], destination[1], 8 + len(datagram), check)
    pseudo = address(source[0]) + address(destination[0]) + struct.pack(">BBH", 0, 17, 8 + len(datagram))
    check = checksum(pseudo + head(0) + datagram) or 0xFFFF
    return in_ip(17, source[0], destination[0], head(check) + datagram)


def pcap(packets):
    """The bytes of a capture of raw IP of (ns, packet, bytes that are kept) in order of time."""
    out = struct.pack("<IHHiIII", PCAP_NS, 2, 4, 0, 0, SNAP, RAW_IP)
    for time, packet, kept in packets:
        out += struct.pack("<IIII", time // 10**9, time % 10**9, kept, len(packet)) + packet[:kept]
    return out


def read_pcap(path):
    """The whole datagrams of UDP over IPv4 in a capture as above; what else there is is left out."""
    data = path.read_bytes()
    magic, _, _, _, _, _, link = struct.unpack_from("<IHHiIII", data)
    assert (magic, link) == (PCAP_NS, RAW_IP), f"{path}: not a capture of raw IP in nanoseconds"
    at, number = 24, 0
    while at < len(data):
        seconds, ns, kept, length = struct.unpack_from("<IIII", data, at)
        packet, at, number = data[at + 16 : at + 16 + kept], at + 16 + kept, number + 1
        if packet[9] != 17 or kept < length:
            continue
        ports = struct.unpack_from(">HH", packet, 20)
        yield Frame(number, seconds * 10**9 + ns, (packet[12:16], ports[0]), (packet[16:20], ports[1]), packet[28:])
