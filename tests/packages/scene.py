"""As scene.c, of a liver, and from Python: the libraries by ctypes. Then a session whose force is limited.

usage: scene.py LIBRARIES SCENE CAPTURE SERVER KEY
"""
import ctypes
import pathlib
import sys
import tempfile
import time

U32, U64, I64, F64, TEXT = ctypes.c_uint32, ctypes.c_uint64, ctypes.c_int64, ctypes.c_double, ctypes.c_char_p
OK, FAILED = 0, 1
END, TOOL_STATE, FORCE_SAMPLE = 0, 6, 7
LIVE = 1


class Sized(ctypes.Structure):
    def __init__(self, **values):
        super().__init__(struct_size=ctypes.sizeof(type(self)), **values)


class ToolState(Sized):
    _fields_ = [("struct_size", U32), ("flags", U32), ("buttons", U32), ("tool", U32), ("position", F64 * 3),
                ("velocity", F64 * 3), ("orientation", F64 * 4), ("time_ns", I64), ("tick", U64), ("newest_sample", U64)]


class ForceSample(Sized):
    _fields_ = [("struct_size", U32), ("flags", U32), ("tool", U32), ("reserved", U32), ("number", U64), ("tick", U64),
                ("time_ns", I64), ("position", F64 * 3), ("force", F64 * 3), ("torque", F64 * 3), ("normal", F64 * 3),
                ("gap", F64), ("tangent", F64 * 9), ("surface_velocity", F64 * 3), ("mean_force", F64 * 3),
                ("step_ns", I64)]


class Datagram(Sized):
    _fields_ = [("struct_size", U32), ("type", U32), ("direction", U32), ("bytes", U32), ("time_ns", I64),
                ("session", U64), ("sequence", U64)]


class Options(Sized):
    _fields_ = [("struct_size", U32), ("insecure", U32), ("client_file", TEXT), ("server", TEXT), ("key_file", TEXT),
                ("method", TEXT), ("max_force", F64)]


class Rendered(Sized):
    _fields_ = [("struct_size", U32), ("state", U32), ("fault", U32), ("flags", U32), ("tick", U64), ("sample", U64),
                ("force", F64 * 3), ("law_newton", F64), ("gain", F64), ("age", F64), ("normal", F64 * 3), ("gap", F64)]


def library(folder, name):
    return ctypes.CDLL(str(pathlib.Path(folder) / f"libpalpate-{name}.so.0"))


def checked(function, *arguments):
    error = ctypes.create_string_buffer(512)
    code = function(*arguments, error, ctypes.c_size_t(len(error)))
    if code != OK:
        raise RuntimeError(f"{code}: {error.value.decode()}")


def opened(function, *arguments):
    handle = ctypes.c_void_p()
    checked(function, *arguments, ctypes.byref(handle))
    return handle


def datagrams(client, file):
    """Each datagram with the tool state or force sample in it."""
    capture = opened(client.palpate_capture_open, file.encode())
    try:
        while True:
            datagram, state, sample = Datagram(), ToolState(), ForceSample()
            checked(client.palpate_capture_next, capture, *map(ctypes.byref, (datagram, state, sample)))
            if datagram.type == END:
                return
            yield datagram, state if datagram.type == TOOL_STATE else sample
    finally:
        client.palpate_capture_close(capture)


def check_scene(sim, client, scene_file, capture_file):
    scene, states, now, contacts = opened(sim.palpate_scene_open, scene_file.encode()), {}, 0, 0
    for datagram, message in datagrams(client, capture_file):
        if datagram.type == TOOL_STATE:
            states[message.tick] = message
        elif datagram.type == FORCE_SAMPLE:
            state, stepped = states[message.tick], ForceSample()
            dt, now = 1e-9 * (state.time_ns - now), state.time_ns
            checked(sim.palpate_scene_step, scene, ctypes.byref(state), ctypes.c_size_t(1), F64(dt),
                    ctypes.byref(stepped))
            assert list(stepped.force) == list(message.force), "a force is another"
            contacts += stepped.flags & 1
    sim.palpate_scene_close(scene)
    assert contacts > 10, "the tool hardly touched"
    return contacts


def check_broken_capture(client, file):
    """What breaks off says so, after what it holds."""
    with tempfile.NamedTemporaryFile(suffix=".pcap") as broken:
        broken.write(pathlib.Path(file).read_bytes()[:5000])
        broken.flush()
        found = 0
        try:
            for _ in datagrams(client, broken.name):
                found += 1
            raise AssertionError("nothing was said")
        except RuntimeError as e:
            assert str(e).startswith(f"{FAILED}: {broken.name}") and found > 2, e


def check_limit(client, server, key, newton=0.2):
    """The tool pressed 3 mm deep into the block: the law says about 1 N, the limiter less."""
    options = Options(server=server.encode(), key_file=key.encode(), max_force=newton)
    session = opened(client.palpate_session_open, ctypes.byref(options))
    most = law = 0
    rendered, begin = Rendered(), time.monotonic()
    while time.monotonic() - begin < 2.5:
        tool = ToolState(position=(0, 0.003, 0))
        assert client.palpate_session_tick(session, ctypes.byref(tool), ctypes.byref(rendered)) == OK
        most = max(most, sum(f * f for f in rendered.force) ** 0.5)
        law = max(law, rendered.law_newton)
        time.sleep(0.002)
    assert rendered.state == LIVE and law > 0.5, (rendered.state, law)
    assert 0.9 * newton < most <= newton * (1 + 1e-12), most
    client.palpate_session_close(session)
    return law, most


def main():
    folder, scene, capture, server, key = sys.argv[1:]
    sim, client = library(folder, "sim"), library(folder, "client")
    contacts = check_scene(sim, client, scene, capture)
    check_broken_capture(client, capture)
    law, most = check_limit(client, server, key)
    print(f"scene.py: {contacts} samples in contact, the same forces; {law:.2f} N asked for, {most:.2f} N rendered")


main()
