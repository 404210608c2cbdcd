"""Datagrams with a value at each limit of each field, or just outside, and at the ends of its type: for make_captures. Which
of them are refused, the dissector and the codec say for themselves (`check`; tests/unit/protocol/capture_test.cpp)."""
import math
import pathlib
import struct

from captures import header
from message_fields import SIZES, snake, table_of

ROOT = pathlib.Path(__file__).resolve().parents[2]
FORMATS = {"u8": "B", "u16": "H", "u32": "I", "u64": "Q", "i64": "q", "f32": "f", "f64": "d"}
SESSION = 0x0123456789ABCDEF
# What fields have while another is tried, if not 1 or 0.125: so that they agree with one another.
OTHERS = {"relaxed.first": 0, "relaxed.count": 0, "surface.version": 0}
# A limit of several fields together, which only the codec knows: the shares of a series.
TOGETHER = {("relaxed.fraction", 1.0)}


def default_of(step):
    if step["name"] in OTHERS:
        return OTHERS[step["name"]]
    return 0 if "flags" in step else 0.125 if step["type"] in ("f32", "f64") else 1


def payload_of(steps, values, counts=None):
    """The bytes of steps: `values` of fields by name, else defaults."""
    out, counts = b"", {} if counts is None else counts
    for step in steps:
        if "flag" in step:
            mask = next(mask for field in values["flags of"] for flag, mask in field["flags"] if flag == step["flag"])
            out += payload_of(step["steps"], values, counts) if values.get(step["of"], 0) & mask else b""
        elif "count" in step:
            times = math.prod(counts[one] if isinstance(one, str) else one for one in step["count"])
            most = step.get("most", times)
            if "each" in step:
                most = min(most, step["room"] // max(counts[step["each"]], 1))
            out += payload_of(step["steps"], values, counts) * min(times, most)
        else:
            out += bytes_of(step, values)
            counts[step["name"]] = min(values.get(step["name"], default_of(step)), step.get("at_most", math.inf)) \
                if step["type"] in ("u8", "u32") else 0
    return out


def bytes_of(step, values):
    if step["type"] in ("bytes", "text"):
        return values.get(step["name"], b"a" * step["size"])
    value = values.get(step["name"], default_of(step))
    parts = step.get("parts", [None])
    if not isinstance(value, list):
        value = [0.0, 1.0, 0.0, 0.0][: len(parts)] if "unit_length" in step else [value] + [default_of(step)] * (len(parts) - 1)
    return struct.pack(f"<{len(parts)}{FORMATS[step['type']]}", *value)


def next_real(value, up, kind):
    if kind == "f64":
        return math.nextafter(value, math.inf if up else -math.inf)
    bits = struct.unpack("<i", struct.pack("<f", value))[0]
    away = up == (value > 0)
    return struct.unpack("<f", struct.pack("<i", bits + (1 if away else -1)))[0] if value else (1e-45 if up else -1e-45)


def tries(step):
    """Values of a field."""
    kind, (least, most, *_) = step["type"], step.get("within", (0, 0))
    if kind == "text":
        return [b"\0" * step["size"], b"a\x7f".ljust(step["size"], b"\0"), b"\xc3\xa9".ljust(step["size"], b"\0")]
    if "unit_length" in step:
        count, tolerance = len(step["parts"]), step["unit_length"]["tolerance"]
        ends = [0.0, 0.9, math.sqrt(1 - 1.01 * tolerance), math.sqrt(1 - 0.99 * tolerance), math.sqrt(1 + 1.01 * tolerance)]
        return [[end] + [0.0] * (count - 1) for end in ends]
    if kind in ("f32", "f64"):
        found = [least, most, next_real(least, False, kind) if least > -3e38 else -3e38, next_real(most, True, kind),
                 next_real(least, True, kind) if least > -3e38 else 0.0, 0.0, -1e12, 1e12]
        return [float(one) for one in found if kind == "f64" or abs(one) < 3.4e38]
    bits = 8 * SIZES[kind]
    low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if kind == "i64" else (0, (1 << bits) - 1)
    beyond = 1 if abs(most) < 2**53 else 2**10  # what a real number of 64 bits tells apart
    found = [int(one) for one in (least, least - beyond, most, most + beyond, low, high, 0, 1)]
    return [one for one in dict.fromkeys(found) if low <= one <= high]


def fields_with_flags(steps, flags=()):
    """Each field, with the flags that it needs."""
    for step in steps:
        if "steps" in step:
            more = ((step["of"], step["flag"]),) if "flag" in step else ()
            yield from fields_with_flags(step["steps"], flags + more)
        else:
            yield step, flags


def cases():
    """What each datagram tries, and its bytes."""
    messages = table_of(ROOT / "protocol/messages.h", "protocol/messages.h", ROOT)["messages"]
    for message in messages:
        fields = list(fields_with_flags(message["steps"]))
        with_flags = [field for field, _ in fields if "flags" in field]
        for field, needed in fields:
            if field["type"] == "bytes" or "flags" in field or message["name"] == "Hello":
                continue
            for value in tries(field):
                if (field["name"], value if isinstance(value, float) else None) in TOGETHER:
                    continue
                masks = {flag: mask for one in with_flags for flag, mask in one["flags"]}
                values = {"flags of": with_flags, field["name"]: value}
                values.update({of: sum(masks[flag] for _, flag in needed) for of, _ in needed})
                payload = payload_of(message["steps"], values)
                yield (f"{snake(message['name'])}: {field['name']} = {value}", message["sender"],
                       header(2, message["type"], len(payload), 0, 0, SESSION, 1) + payload)
