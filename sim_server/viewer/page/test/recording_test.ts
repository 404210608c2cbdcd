// What is kept of a session, within its bounds, and how it plays again.
import assert from "node:assert/strict";
import { test } from "node:test";
import { decode } from "../src/messages";
import { Playback } from "../src/playback";
import { Recording, save_records } from "../src/recording";
import { Series } from "../src/series";
import { Session } from "../src/session";
import { Bytes, kAtRest, tetrahedron, tetrahedron_at } from "./bytes";

const kScene = '{"scene":{"title":"one","control":true,"pausable":true,"scenes":["a"],"tools":[],"fields":["strain_energy"]}}';
const kRate = 10;

/** The height of the last vertex at a step, m. */
function height(step: number): number {
  return 1 - step / 1000;
}

/** Steps of a session of which only the last vertex moves; after the first surface none is whole. */
function* steps(count: number): Generator<[number, string | ArrayBuffer]> {
  yield [0, kScene];
  yield [0, tetrahedron(1)];
  yield [0, tetrahedron_at(1, 0, 0, kAtRest)];
  for (let step = 1; step < count; step++) {
    const t = step / kRate;
    const q = Math.round(((height(step) + 1) / 2) * 65535);
    yield [t, new Bytes().u8(2, 0, 0, 0).u32(1, step).f64(t).u32(1, 0).u32(3).u16(32768, 32768, q).done()];
    yield [t, JSON.stringify({ state: { t, step, step_ms: step } })];
    yield [t, new Bytes().u8(4, 0, 0, 0).f64(t).f32(step).u32(0).done()];
  }
}

function record(count: number, seconds: number, bytes: number): Recording {
  const session = new Session();
  const recording = new Recording({ seconds, bytes });
  for (const [, data] of steps(count)) {
    const message = decode(data)!;
    session.apply(message);
    recording.add(data, message, session);
  }
  return recording;
}

function play(recording: Recording): { playback: Playback; session: Session } {
  const session = new Session();
  return { playback: new Playback(recording.save().buffer as ArrayBuffer, session), session };
}

test("a recording is bounded in time and in bytes, and its oldest piece begins with the whole surface", () => {
  const long = record(1000, 20, 1e9);
  assert.ok(long.seconds <= 20 && long.seconds > 18, `${long.seconds} s`);
  const small = record(1000, 1e9, 20_000);
  assert.ok(small.bytes <= 20_000 && small.bytes > 15_000, `${small.bytes} bytes`);
  assert.ok(Math.abs(small.save().length - small.bytes) < 1000);
  const { playback, session } = play(long);
  assert.ok(playback.start >= 79 && Math.abs(playback.end - 99.9) < 1e-9);
  playback.seek(playback.start);
  assert.ok(session.shape?.known);
});

test("a session that is paused takes no room, and one without time is still in pieces", () => {
  const session = new Session();
  const recording = new Recording({ seconds: 20, bytes: 1e5 });
  const add = (data: string | ArrayBuffer) => {
    const message = decode(data)!;
    session.apply(message);
    recording.add(data, message, session);
  };
  for (const [, data] of steps(20)) add(data);
  const paused = JSON.stringify({ state: { t: 1.9, step: 19, paused: true } });
  add(paused);
  const { bytes } = recording;
  for (let i = 0; i < 1000; i++) add(paused);
  assert.equal(recording.bytes, bytes);
  // What a client tells goes on; it has no time of its own.
  for (let i = 0; i < 5000; i++) add(JSON.stringify({ client: { tool: 0, missed: i } }));
  assert.ok(recording.bytes < 1.1e5, `${recording.bytes}`);
});

test("a client that left is shown no more", () => {
  const session = new Session();
  const state = (held: boolean) => JSON.stringify({ state: { t: 1, tools: [{ held }] } });
  session.apply(decode(state(true)));
  session.apply(decode('{"client": {"tool": 0, "age_ms": 7}}'));
  assert.equal(session.clients.get(0)?.age_ms, 7);
  session.apply(decode(state(false)));
  assert.equal(session.clients.size, 0);
});

test("a seek shows what was there, whether it goes on, back, or a little", () => {
  const { playback, session } = play(record(600, 1e9, 1e9));
  for (const step of [300, 301, 40, 599, 1, 450]) {
    playback.seek(step / kRate);
    assert.equal(session.shape?.step, step);
    assert.equal(session.state?.step, step);
    assert.ok(Math.abs(session.shape!.p[11] - height(step)) < 5e-5);
    assert.ok(session.series(0).samples.length >= Math.min(step, 290));
    assert.equal(session.series(0).samples.value(session.series(0).samples.length - 1, 0), step);
  }
});

test("played in small pieces, it is what it was in one", () => {
  const { playback, session } = play(record(100, 1e9, 1e9));
  playback.seek(playback.start);
  playback.play();
  for (let i = 0; i < 50; i++) playback.advance(0.0903);
  assert.equal(session.state?.step, Math.floor(playback.now * kRate + 1e-6));
  playback.speed = 2;
  for (let i = 0; i < 60; i++) playback.advance(0.05);
  assert.equal(session.shape?.step, 99);
  assert.equal(playback.playing, false);
  playback.step(-1);
  assert.equal(session.state?.step, 98);
  playback.play();
  playback.advance(10);
  playback.play(); // from the start again
  assert.equal(playback.now, playback.start);
});

test("who opens it can control nothing", () => {
  const { playback, session } = play(record(20, 1e9, 1e9));
  playback.seek(1);
  assert.deepEqual(
    [session.scene?.recorded, session.scene?.control, session.scene?.pausable, session.scene?.scenes],
    [true, false, false, []],
  );
});

test("another scene starts the recording again", () => {
  const session = new Session();
  const recording = new Recording();
  for (const [, data] of [...steps(50), ...steps(20)]) {
    const message = decode(data)!;
    session.apply(message);
    recording.add(data, message, session);
  }
  assert.ok(Math.abs(recording.seconds - 1.9) < 0.11, `${recording.seconds}`);
});

test("a topology that changes in between is there again after a seek before and after it", () => {
  const session = new Session();
  const recording = new Recording({ seconds: 1e9, bytes: 1e9 });
  const other = [...steps(20)].map(([, data]) => data);
  for (let step = 20; step < 40; step++) {
    if (step === 20) other.push(tetrahedron(2));
    other.push(tetrahedron_at(2, step, step / kRate, kAtRest));
  }
  for (const data of other) {
    const message = decode(data)!;
    session.apply(message);
    recording.add(data, message, session);
  }
  const played = play(recording);
  for (const step of [30, 10, 35]) {
    played.playback.seek(step / kRate);
    assert.equal(played.session.shape?.topology.version, step < 20 ? 1 : 2);
    assert.equal(played.session.shape?.step, step);
  }
});

test("when the piece with a topology goes, the topology stays", () => {
  const session = new Session();
  const recording = new Recording({ seconds: 3, bytes: 1e9 });
  const messages = [...steps(20)].map(([, data]) => data);
  messages.push(tetrahedron(2));
  for (let step = 20; step < 200; step++) messages.push(tetrahedron_at(2, step, step / kRate, kAtRest));
  for (const data of messages) {
    const message = decode(data)!;
    session.apply(message);
    recording.add(data, message, session);
  }
  const played = play(recording);
  played.playback.seek(18);
  assert.equal(played.session.shape?.topology.version, 2);
  assert.equal(played.session.shape?.step, 180);
});

test("each tick has a time of its own, and laws that change their number start a new series", () => {
  const session = new Session();
  session.apply(decode(new Bytes().u8(3, 0, 1, 0).u32(3).f64(2).f32(0.25).f32(1, 2, 3).f32(7, 8, 9).done()));
  const { ticks } = session.series(0);
  assert.deepEqual([0, 1, 2].map((i) => [ticks.time(i), ticks.value(i, 0), ticks.value(i, 1)]), [[2, 1, 7], [2.25, 2, 8], [2.5, 3, 9]]);
  assert.equal(session.t, 2.5);
  session.apply(decode(new Bytes().u8(3, 0, 0, 0).u32(1).f64(3).f32(0.25).f32(4).done()));
  assert.equal(session.series(0).ticks.length, 1);
});

test("a file that is cut short plays as far as it goes; one that is none is empty", () => {
  const whole = record(50, 1e9, 1e9).save();
  const session = new Session();
  const cut = new Playback(whole.slice(0, whole.length - 5).buffer, session);
  assert.ok(cut.damaged);
  cut.seek(1e9);
  assert.equal(session.state?.step, 49);
  assert.ok(new Playback(new ArrayBuffer(3), session).empty);
  assert.ok(new Playback(Uint8Array.from({ length: 40 }, () => 255).buffer, session).empty);
});

test("records are written as the contract has them", () => {
  const expected = new Bytes().u32(2).u8(0, 0, 0, 0).f64(1.5).u8(123, 125).u32(1).u8(1, 0, 0, 0).f64(2).u8(9).done();
  const made = save_records([
    { text: true, t: 1.5, bytes: new TextEncoder().encode("{}") },
    { text: false, t: 2, bytes: Uint8Array.of(9) },
  ]);
  assert.deepEqual(made.buffer, expected);
});

test("a series keeps its newest rows, finds a time, and thins out without losing the ends of the window", () => {
  const series = new Series(1, 100);
  for (let i = 0; i < 250; i++) series.push(i, [2 * i]);
  assert.equal(series.length, 100);
  assert.deepEqual([series.time(0), series.value(99, 0)], [150, 498]);
  assert.equal(series.row_at(200.5), 51);
  const [times, values] = series.since(200, 10);
  assert.ok(times.length <= 10 && times.length >= 5);
  times.forEach((t, i) => assert.equal(values[i], 2 * t!));
  series.push(3, [1]); // time went back: another session
  assert.equal(series.length, 1);
});

test("a cut travels, is recorded, and a seek comes to the triangles of that time", () => {
  const triangles = (version: number, m: number, places: number[] | null, corners: number[]): ArrayBuffer => {
    const bytes = new Bytes().u8(6, 0, 0, 0).u32(version, m, corners.length / 3, places ? 0 : 1);
    return (places ? bytes.u32(...places) : bytes).u32(...corners).done();
  };
  const session = new Session();
  const recording = new Recording({ seconds: 1e9, bytes: 1e9 });
  const records: { text: boolean; t: number; bytes: Uint8Array }[] = [];
  const take = (t: number, data: string | ArrayBuffer): void => {
    const message = decode(data)!;
    assert.ok(session.apply(message) !== null);
    recording.add(data, message, session);
    const text = typeof data === "string";
    records.push({ text, t, bytes: text ? new TextEncoder().encode(data) : new Uint8Array(data) });
  };
  let version = 1;
  for (const [t, data] of steps(60)) {
    if (typeof data === "string" || new Uint8Array(data)[0] !== 2) {
      take(t, data);
      continue;
    }
    if (t === 1.5) take(t, triangles(++version, 3, [1], [0, 3, 2]));
    if (t === 3.5) take(t, triangles(++version, 2, null, [0, 1, 2, 0, 2, 1]));
    const bytes = data.slice(0);
    new DataView(bytes).setUint32(4, version, true);
    take(t, bytes);
  }
  for (const bytes of [recording.save(), save_records(records)]) {
    const played = new Session();
    const playback = new Playback(bytes.buffer as ArrayBuffer, played);
    const counts: number[] = [];
    for (const t of [5, 1, 2, 4, 1.5, 3.3, 3.5, 0.2]) {
      playback.seek(t);
      counts.push(played.shape!.m);
      assert.ok(Math.abs(played.shape!.t - t) < 0.11, `${played.shape!.t} at ${t}`);
    }
    assert.deepEqual(counts, [2, 4, 3, 2, 3, 3, 2, 4]);
  }
});

test("triangles that name vertices or places that are not there are refused", () => {
  const session = new Session();
  for (const [, data] of [...steps(2)].slice(0, 3)) session.apply(decode(data));
  assert.equal(decode(new Bytes().u8(6, 0, 0, 0).u32(2, 1, 1, 0).u32(1).u32(0, 1, 2).done()), null);
  const stranger = decode(new Bytes().u8(6, 0, 0, 0).u32(2, 1, 1, 1).u32(0, 1, 9).done())!;
  const m = session.shape!.m;
  session.apply(stranger);
  assert.equal(session.shape!.m, m);
});
