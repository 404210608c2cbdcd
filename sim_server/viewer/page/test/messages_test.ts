// The bytes are written here by hand from ../../MESSAGES.md, not by the page's own code.
import assert from "node:assert/strict";
import { test } from "node:test";
import { decode, encode_whole } from "../src/messages";
import { Bytes, tetrahedron } from "./bytes";

test("a topology is read, and one that is cut short or names a vertex too many is none", () => {
  const message = decode(tetrahedron(5));
  assert.ok(message?.kind === "topology");
  assert.equal(message.version, 5);
  assert.deepEqual([...message.corners.slice(0, 3)], [0, 2, 1]);
  assert.deepEqual([...message.flags], [1, 0, 2, 3]);
  assert.equal(message.box_min[0], -1);
  assert.equal(message.box_size[2], 2);
  const whole = tetrahedron(5);
  assert.equal(decode(whole.slice(0, whole.byteLength - 1)), null);
  assert.equal(decode(tetrahedron(5, 4)), null);
});

test("a surface of some vertices, and one of all", () => {
  const some = new Bytes().u8(2, 0, 0, 0).u32(5, 77).f64(1.25).u32(1, 0).u32(3).u16(0, 65535, 32768).done();
  const message = decode(some);
  assert.ok(message?.kind === "surface");
  assert.deepEqual([message.version, message.step, message.t], [5, 77, 1.25]);
  assert.deepEqual([...message.vertices!], [3]);
  assert.deepEqual([...message.q], [0, 65535, 32768]);
  const all = decode(new Bytes().u8(2, 0, 0, 0).u32(5, 77).f64(1).u32(1, 1).u16(1, 2, 3).done());
  assert.ok(all?.kind === "surface" && all.vertices === null);
  assert.equal(decode(new Bytes().u8(2, 0, 0, 0).u32(5, 77).f64(1).u32(2, 1).u16(1, 2, 3).done()), null);
});

test("a whole surface is written as the contract has it", () => {
  const expected = new Bytes().u8(2, 0, 0, 0).u32(9, 3).f64(0.5).u32(2, 1).u16(1, 2, 3, 4, 5, 65535).done();
  assert.deepEqual(encode_whole(9, 3, 0.5, Uint16Array.of(1, 2, 3, 4, 5, 65535)), expected);
});

test("ticks: felt first, then the laws, a tick in a row", () => {
  const bytes = new Bytes().u8(3, 1, 2, 0).u32(2).f64(4).f32(0.5).f32(1, 2).f32(10, 20, 11, NaN).done();
  const message = decode(bytes);
  assert.ok(message?.kind === "ticks");
  assert.deepEqual([message.tool, message.laws, message.t, message.dt], [1, 2, 4, 0.5]);
  assert.deepEqual([...message.felt], [1, 2]);
  assert.deepEqual([...message.by_law], [10, 20, 11, NaN]);
  assert.equal(decode(bytes.slice(0, -4)), null);
});

test("a sample and a field", () => {
  const sample = decode(new Bytes().u8(4, 2, 3, 1).f64(1.5).f32(0.25).u32(8).done());
  assert.deepEqual(sample, { kind: "sample", tool: 2, t: 1.5, missed: 259, force: 0.25, flags: 8 });
  const field = decode(new Bytes().u8(5, 1, 0, 0).u32(7, 2).f32(100).u8(0, 255).done());
  assert.ok(field?.kind === "field");
  assert.deepEqual([field.which, field.version, field.largest, ...field.share], [1, 7, 100, 0, 255]);
});

test("what is no message is null, whatever it is", () => {
  for (const nothing of ["", "{", "[]", "null", '{"scene":3}', '{"unknown":{}}', new ArrayBuffer(0)]) {
    assert.equal(decode(nothing), null);
  }
  for (let kind = 0; kind < 256; kind++) assert.equal(decode(new Bytes().u8(kind, 0, 0, 0).u32(4e9, 4e9).done()), null);
});

test("a text that lacks things, or has them of another type, becomes dashes and not an error", () => {
  const state = decode('{"state":{"t":2,"step_ms":"x","tools":[{"p":[1,2]},{"loads":[[1,2,3],[4,0,0,1]],"held":true}],"peers":7}}');
  assert.ok(state?.kind === "state");
  assert.equal(state.state.step_ms, null);
  assert.deepEqual(state.state.tools[0].p, [0, 0, 0]);
  assert.deepEqual(state.state.tools[0].q, [1, 0, 0, 0]);
  assert.deepEqual(state.state.tools[1].loads, [[4, 0, 0, 1]]);
  assert.deepEqual(state.state.peers, []);
  const client = decode('{"client":{"tool":1,"errors_percent":[1,null],"total_percent":4.5,"parts_percent":{"fades":0.5,"limits":null},"interventions":{"clamped":2},"states":["fading"]}}');
  assert.ok(client?.kind === "client");
  assert.deepEqual(client.clients[0].errors_percent, [1, null]);
  assert.equal(client.clients[0].total_percent, 4.5);
  assert.deepEqual(client.clients[0].parts_percent, [["fades", 0.5], ["limits", null]]);
  assert.equal(client.clients[0].beside, "");
  assert.deepEqual(client.clients[0].interventions, [["clamped", 2]]);
  assert.deepEqual(client.clients[0].states, ["fading"]);
});
