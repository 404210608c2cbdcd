// What is measured on the surface, against numbers from closed forms.
import assert from "node:assert/strict";
import { test } from "node:test";
import { nice_above, Scale, kMeasures } from "../src/colours";
import { decode, type Surface, type Topology } from "../src/messages";
import { Shape } from "../src/shape";
import { Bytes, kAtRest, tetrahedron, tetrahedron_at } from "./bytes";

const kStep = 2 / 65535; // m: what a unit of a coordinate is

function shape(): Shape {
  return new Shape(decode(tetrahedron(1)) as Topology);
}

function at(places: number[]): Surface {
  return decode(tetrahedron_at(1, 4, 0.5, places)) as Surface;
}

function near(actual: number, expected: number, tolerance: number): void {
  assert.ok(Math.abs(actual - expected) <= tolerance, `${actual} is not ${expected} within ${tolerance}`);
}

test("vertices that a message does not name stand where they were", () => {
  const body = shape();
  const only_last = decode(new Bytes().u8(2, 0, 0, 0).u32(1, 5).f64(1).u32(1, 0).u32(3).u16(65535, 0, 0).done()) as Surface;
  assert.equal(body.move(only_last), false); // no whole one came before
  assert.ok(body.move(at(kAtRest)));
  assert.ok(body.move(only_last));
  near(body.p[9], 1, kStep);
  near(body.p[10], -1, kStep);
  near(body.p[3], 1, kStep);
  assert.equal(body.step, 5);
  assert.equal(body.move({ ...only_last, version: 2 }), false);
  assert.equal(body.move({ ...only_last, vertices: Uint32Array.of(4) }), false);
});

test("normals point outward", () => {
  const body = shape();
  const [x, y, z] = body.normals.slice(0, 3);
  near(x, -1 / Math.sqrt(3), 1e-6);
  near(y, x, 1e-6);
  near(z, x, 1e-6);
});

test("displacement is a distance; an even stretch is the same everywhere, in whatever direction it goes", () => {
  const body = shape();
  const out = new Float32Array(4);
  body.move(at(kAtRest.map((x, i) => (i >= 9 && i % 3 === 0 ? 0.3 : i >= 9 && i % 3 === 1 ? 0.4 : x))));
  body.displacement(out);
  near(out[3], 0.5, 2 * kStep);
  near(out[1], 0, 2 * kStep);
  body.move(at(kAtRest.map((x) => 0.9 * x)));
  body.stretch(out);
  for (const value of out) near(value, 0, 4 * kStep); // shorter everywhere: no stretch
  const half = new Shape({ ...(decode(tetrahedron(1)) as Topology), rest: Float32Array.from(kAtRest, (x) => x / 2) });
  half.move(at(kAtRest.map((x) => 0.6 * x)));
  half.stretch(out);
  for (const value of out) near(value, 0.2, 8 * kStep);
});

test("a triangle pulled along one axis stretches by that", () => {
  const body = shape();
  const out = new Float32Array(4);
  body.topology.corners.set([0, 2, 1, 0, 2, 1, 0, 2, 1, 0, 2, 1]); // all four are the one in the plane z = 0
  const flat = new Shape(body.topology);
  flat.topology.rest.forEach((x, i) => (flat.topology.rest[i] = x / 2));
  const pulled = new Shape({ ...flat.topology });
  pulled.move(at([0, 0, 0, 0.75, 0, 0, 0, 0.5, 0, 0, 0, 0.5]));
  pulled.stretch(out);
  near(out[0], 0.5, 8 * kStep);
});

test("pressure is the load across the surface over a vertex's share of the area", () => {
  const body = shape();
  body.move(at(kAtRest));
  body.update_normals();
  const out = new Float32Array(4);
  const load: [number, number, number, number] = [0, 3, 3, 3]; // N, along the inward normal: 3 sqrt(3)
  const tool = { held: true, p: [0, 0, 0], q: [1, 0, 0, 0], f: [0, 0, 0], contact: true, flagged: false, loads: [load] };
  body.pressure(out, [tool as never]);
  near(out[0], (3 * Math.sqrt(3)) / (3 * 0.5 / 3), 0.01); // three triangles of half a square metre, a third of each
  body.pressure(out, [{ ...tool, loads: [[0, -3, -3, -3]] } as never]);
  assert.equal(out[0], 0); // a pull is no pressure
});

test("each edge once", () => {
  assert.equal(shape().edges().length, 2 * 6);
});

test("the legend's top is a number one can read, rises at once and falls late", () => {
  assert.deepEqual([0.9, 1, 1.01, 2.1, 70].map(nice_above), [1, 1, 2, 5, 100]);
  near(nice_above(0.03), 0.05, 1e-12);
  const scale = new Scale();
  const mm = kMeasures[0];
  near(scale.follow(0, mm, 0), 0.5, 1e-12);
  assert.equal(scale.follow(0.0031, mm, 10), 5);
  assert.equal(scale.follow(0.0001, mm, 1000), 5);
  near(scale.follow(0.0001, mm, 9000), 0.5, 1e-12);
});

test("a place is as far from the surface as from its faces, edges and corners, whichever is nearest", () => {
  const flat = (corners: number[], rest: number[]): Shape =>
    new Shape({ ...(decode(tetrahedron(1)) as Topology), rest: Float32Array.from(rest), corners: Uint32Array.from(corners) });
  // The last vertex is of no triangle: inside, or cut away.
  const body = flat([0, 1, 2], [0, 0, 0, 0.03, 0, 0, 0, 0.03, 0, 0.01, 0.01, 0.004]);
  near(body.distance([0.01, 0.01, 0.004]), 0.004, 1e-8); // over the face, 10 mm and more from any corner
  near(body.distance([-0.003, 0.01, 0.004]), 0.005, 1e-8); // beside an edge
  near(body.distance([0.02, 0.02, 0]), 0.01 / Math.SQRT2, 1e-8); // beyond the longest one
  near(body.distance([0.033, -0.004, 0]), 0.005, 1e-8); // at a corner
  near(body.distance([0.01, 0.01, -0.2]), 0.2, 1e-7);
  near(flat([0, 1, 1], [0, 0, 0, 0.03, 0, 0]).distance([0.015, 0.02, 0]), 0.02, 1e-8); // one without an area
  assert.equal(body.nearest([0.01, 0.01, 0.004]), 0);
  const out = new Float32Array(4);
  body.p[9] += 0.5;
  body.displacement(out);
  assert.equal(out[3], 0);
});

test("triangles that are more than are named are refused", () => {
  const body = shape();
  const had = body.m;
  const one = { kind: "triangles" as const, version: 2, places: Uint32Array.of(0), corners: Uint32Array.of(0, 1, 2) };
  assert.equal(body.cut({ ...one, m: had + 2 }), false);
  assert.equal(body.cut({ ...one, m: 1e9 }), false);
  assert.equal(body.cut({ ...one, m: had + 1 }), true);
});
