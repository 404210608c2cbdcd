"""A session that nobody computed, in the messages of sim_server/viewer/MESSAGES.md: a ball of 60 mm that a tool presses
once in four seconds, with forces of a known size, three laws and all that a client says."""
import json
import math
import struct

RADIUS = 0.06  # m, of the ball
TOOL_RADIUS = 0.005  # m
PERIOD = 4.0  # s, from one touch to the next
DEPTH = 0.012  # m, pressed in at most
STIFFNESS = 200.0  # N/m
RATE = 30  # Hz
TICKS = 500  # Hz
LAWS = ["constant", "linear_time", "two_tangents"]
BOX = 0.1  # m, half the side of the box of the positions


def ball(splits=3):
    """Vertices on the unit sphere and outward triangles: an icosahedron, split."""
    g = (1 + math.sqrt(5)) / 2
    places = [unit(p) for p in [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g),
                                (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
             (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
             (8, 6, 7), (9, 8, 1)]
    for _ in range(splits):
        middles = {}

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(places)
                places.append(unit([x + y for x, y in zip(places[a], places[b])]))
            return middles[key]

        faces = [face for a, b, c in faces
                 for ab, bc, ca in [(middle(a, b), middle(b, c), middle(c, a))]
                 for face in [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]]
    return places, faces


def unit(p):
    length = math.sqrt(sum(x * x for x in p))
    return tuple(x / length for x in p)


class MadeSession:
    """The messages at any time. `shift` moves the tool sideways, as a page's pointer would."""

    def __init__(self, splits=3):
        self.unit, self.faces = ball(splits)
        self.shift = (0.0, 0.0, 0.0)

    def scene(self, control=True, recorded=False):
        return json.dumps({"scene": {
            "title": "A ball that nobody computed", "file": "made/ball.toml", "model": "made_up", "rate_hz": RATE,
            "scenes": ["ball", "liver_breathing"] if control else [], "control": control, "pausable": control,
            "recorded": recorded, "fields": ["strain_energy"],
            "tools": [{"shape": "sphere", "radius": TOOL_RADIUS, "length": 0, "trocar": None, "axis": [0, 0, 1]}]}})

    def topology(self):
        n, m = len(self.unit), len(self.faces)
        rest = [RADIUS * x for p in self.unit for x in p]
        flags = bytes((1 if z < -0.6 else 0) | (2 if z > 0.2 else 0) for _, _, z in self.unit)
        return (struct.pack("<B3xIII6f", 1, 7, n, m, -BOX, -BOX, -BOX, 2 * BOX, 2 * BOX, 2 * BOX)
                + struct.pack(f"<{3 * n}f", *rest) + struct.pack(f"<{3 * m}I", *[v for f in self.faces for v in f]) + flags)

    def depth(self, t):
        return DEPTH * max(0.0, math.sin(2 * math.pi * t / PERIOD))

    def force(self, t):
        return STIFFNESS * self.depth(t)

    def tip(self, t):
        away = 0.02 * max(0.0, -math.sin(2 * math.pi * t / PERIOD))
        x, y, z = self.shift
        return [x, y, z + RADIUS + TOOL_RADIUS - self.depth(t) + away]

    def places(self, t):
        out = []
        for x, y, z in self.unit:
            beside = math.acos(max(-1.0, min(1.0, z))) * RADIUS
            out += [RADIUS * x, RADIUS * y, RADIUS * z - self.depth(t) * math.exp(-((beside / 0.016) ** 2))]
        return out

    def surface(self, t, whole=True):
        """Whole, or only the upper half, where all the motion is."""
        n = len(self.unit)
        q = [round((x + BOX) / (2 * BOX) * 65535) for x in self.places(t)]
        numbers = [] if whole else [i for i in range(n) if self.unit[i][2] > 0]
        if not whole:
            q = [x for i in numbers for x in q[3 * i:3 * i + 3]]
        return (struct.pack("<B3xIIdII", 2, 7, int(round(t * RATE)), t, len(q) // 3, int(whole))
                + struct.pack(f"<{len(numbers)}I", *numbers) + struct.pack(f"<{len(q)}H", *q))

    def field(self, t):
        largest = 400 * (self.depth(t) / DEPTH) ** 2
        share = bytes(round(255 * math.exp(-((1 - z) / 0.08))) for _, _, z in self.unit)
        return struct.pack("<BB2xIIf", 5, 1, 7, len(share), largest) + share

    def state(self, t, paused=False):
        f = 0.0 if paused else self.force(t)
        near = [i for i, (_, _, z) in enumerate(self.unit) if z > 0.99] if f else []
        return json.dumps({"state": {
            "t": t, "step": int(round(t * RATE)), "paused": paused, "step_ms": 8 + 2 * math.sin(3 * t), "late": int(t) // 7,
            "rate_hz": 30.0, "real_time_factor": 1.0,
            "tools": [{"held": True, "p": self.tip(t), "q": [1, 0, 0, 0], "f": [0.1 * f, 0, f], "contact": f > 0,
                       "errors": {"mesh": {"percent": 41, "source": "estimated"}, "time_step": {"percent": 0, "source": "none by construction"}},
                       "flagged": False, "flagged_samples": 12, "loads": [[i, 0, 0, -f / len(near)] for i in near]}],
            "strain": "strain up to 45 % of the surface under tools, in 12 of 80 steps in contact beyond the 20 % that the law of this tissue is meant for",
            "peers": [{"tool": 0, "address": "127.0.0.1:40112", "loss_percent": 0.4, "rate_hz": 500.0}]}})

    def client(self, t, device="browser"):
        return json.dumps({"client": {
            "tool": 0, "law": "best_recent: two_tangents", "laws": LAWS, "errors_percent": [11 + math.sin(t), 6, 3.2 + 0.5 * math.cos(t)], "total_percent": 45.6,
            "parts_percent": {"extrapolation": 3.2, "outages": 0.4, "fades": 0.9, "limits": 0, "worst tick": 61}, "beside": "a hand can tell 10 % of a force",
            "age_ms": 38 + 9 * math.sin(5 * t), "period_ms": 2.0 + 0.05 * math.sin(40 * t), "missed": 3, "passivity_gain": 1.0,
            "interventions": {"clamped": 0, "slew_limited": 2, "faded": 1}, "states": ["device_lost"], "felt": [0, 0, self.force(t)],
            "p": self.tip(t), "device": device, "has_motors": False}})

    def ticks(self, t, count):
        """`count` ticks that end at t."""
        times = [t - (count - 1 - i) / TICKS for i in range(count)]
        felt, laws = [], []
        for time in times:
            held = self.force(math.floor(time * RATE) / RATE - 0.04)
            true = self.force(time)
            laws += [held, true + 0.15 * math.sin(30 * time) * (true > 0), true]
            felt.append(true)
        return (struct.pack("<BBBxIdf", 3, 0, len(LAWS), count, times[0], 1 / TICKS)
                + struct.pack(f"<{count}f", *felt) + struct.pack(f"<{len(laws)}f", *laws))

    def sample(self, t):
        return struct.pack("<BBxxdfI", 4, 0, t, self.force(t), 0)

    def step(self, number, field=False, paused=False):
        """What a server sends at a step: [(t, message)]."""
        t = number / RATE
        out = [self.surface(t, whole=number % RATE == 0), self.state(t, paused), self.sample(t)]
        if number % 3 == 2:
            out += [self.ticks(t, TICKS * 3 // RATE), self.client(t)]
        if field and number % 3 == 0:
            out.append(self.field(t))
        return [(t, message) for message in out]


def records(messages):
    """[(t, message)] as the bytes of a session's file."""
    out = b""
    for t, message in messages:
        data = message.encode() if isinstance(message, str) else message
        out += struct.pack("<IB3xd", len(data), 0 if isinstance(message, str) else 1, t) + data
    return out


def recorded(seconds=8.0, splits=3):
    made = MadeSession(splits)
    messages = [(0.0, made.scene(control=False, recorded=True)), (0.0, made.topology())]
    for number in range(int(seconds * RATE)):
        messages += made.step(number, field=True)
    return records(messages)
