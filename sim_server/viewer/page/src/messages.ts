// The messages of ../MESSAGES.md, as the server sends them, turned into objects. Whatever is cut short, too long or not
// finite is no message: decode gives null. Nothing here knows of the network or of the screen.
import { decode_text, type Client, type Scene, type State } from "./text_messages";

/** The surface at rest. Vertices in metres, world frame; corners of triangles, seen from outside counter-clockwise. */
export interface Topology {
  kind: "topology";
  version: number;
  box_min: [number, number, number];
  box_size: [number, number, number];
  rest: Float32Array; // 3n, m
  corners: Uint32Array; // 3m
  flags: Uint8Array; // n: 1 fixed, 2 in reach of a tool
}

/** Where vertices are now: box_min + box_size q / 65535. */
export interface Surface {
  kind: "surface";
  version: number;
  step: number;
  t: number; // s
  vertices: Uint32Array | null; // null: all of them
  q: Uint16Array; // 3k
}

/** Consecutive ticks of a client: the force felt, and that of each law (N). */
export interface Ticks {
  kind: "ticks";
  tool: number;
  t: number; // s, of the first
  dt: number; // s
  felt: Float32Array; // n
  laws: number;
  by_law: Float32Array; // n laws, a tick in a row
}

/** A force that the server computed. */
export interface Sample {
  kind: "sample";
  tool: number;
  t: number; // s
  missed: number; // samples just before it that this page did not get
  force: number; // N
  flags: number;
}

/** A number for each vertex: its share of the largest, 255 = all of it. */
export interface Field {
  kind: "field";
  which: number; // 1: strain energy, J/m3
  version: number;
  largest: number;
  share: Uint8Array; // n
}

/** Other triangles of the same vertices: tissue has been removed. */
export interface Triangles {
  kind: "triangles";
  version: number;
  m: number;
  places: Uint32Array | null; // k, below m; null: all of them
  corners: Uint32Array; // 3k
}

export type Message =
  | Topology
  | Triangles
  | Surface
  | Ticks
  | Sample
  | Field
  | { kind: "scene"; scene: Scene }
  | { kind: "state"; state: State }
  | { kind: "client"; clients: Client[] }
  | { kind: "refused"; why: string };

export const kStrainEnergy = 1;
const kLittle = true;

/** A message, or null if it is none that this page knows. The arrays are copies. */
export function decode(data: string | ArrayBuffer): Message | null {
  if (typeof data === "string") return decode_text(data);
  if (data.byteLength < 1) return null;
  const view = new DataView(data);
  switch (view.getUint8(0)) {
    case 1:
      return topology(view);
    case 2:
      return surface(view);
    case 3:
      return ticks(view);
    case 4:
      return sample(view);
    case 5:
      return field(view);
    case 6:
      return triangles(view);
    default:
      return null;
  }
}

function f32(view: DataView, at: number, n: number): Float32Array {
  return new Float32Array(view.buffer.slice(at, at + 4 * n));
}

function u32(view: DataView, at: number, n: number): Uint32Array {
  return new Uint32Array(view.buffer.slice(at, at + 4 * n));
}

function finite(values: ArrayLike<number>): boolean {
  for (let i = 0; i < values.length; i++) if (!Number.isFinite(values[i])) return false;
  return true;
}

function topology(view: DataView): Topology | null {
  if (view.byteLength < 40) return null;
  const version = view.getUint32(4, kLittle);
  const n = view.getUint32(8, kLittle);
  const m = view.getUint32(12, kLittle);
  if (view.byteLength !== 40 + 12 * n + 12 * m + n) return null;
  const box = f32(view, 16, 6);
  const rest = f32(view, 40, 3 * n);
  const corners = u32(view, 40 + 12 * n, 3 * m);
  if (!finite(box) || !finite(rest) || corners.some((c) => c >= n)) return null;
  const flags = new Uint8Array(view.buffer.slice(40 + 12 * n + 12 * m));
  return {
    kind: "topology",
    version,
    box_min: [box[0], box[1], box[2]],
    box_size: [box[3], box[4], box[5]],
    rest,
    corners,
    flags,
  };
}

function surface(view: DataView): Surface | null {
  if (view.byteLength < 28) return null;
  const t = view.getFloat64(12, kLittle);
  const k = view.getUint32(20, kLittle);
  const whole = view.getUint32(24, kLittle) === 1;
  const numbers = whole ? 0 : 4 * k;
  if (view.byteLength !== 28 + numbers + 6 * k || !Number.isFinite(t)) return null;
  return {
    kind: "surface",
    version: view.getUint32(4, kLittle),
    step: view.getUint32(8, kLittle),
    t,
    vertices: whole ? null : u32(view, 28, k),
    q: new Uint16Array(view.buffer.slice(28 + numbers)),
  };
}

function ticks(view: DataView): Ticks | null {
  if (view.byteLength < 20) return null;
  const laws = view.getUint8(2);
  const n = view.getUint32(4, kLittle);
  const t = view.getFloat64(8, kLittle);
  const dt = view.getFloat32(16, kLittle);
  if (view.byteLength !== 20 + 4 * n * (1 + laws) || !Number.isFinite(t) || !(dt > 0)) return null;
  return {
    kind: "ticks",
    tool: view.getUint8(1),
    t,
    dt,
    felt: f32(view, 20, n),
    laws,
    by_law: f32(view, 20 + 4 * n, n * laws),
  };
}

function sample(view: DataView): Sample | null {
  if (view.byteLength !== 20) return null;
  const t = view.getFloat64(4, kLittle);
  const force = view.getFloat32(12, kLittle);
  if (!Number.isFinite(t) || !Number.isFinite(force)) return null;
  return { kind: "sample", tool: view.getUint8(1), t, missed: view.getUint16(2, kLittle), force, flags: view.getUint32(16, kLittle) };
}

function field(view: DataView): Field | null {
  if (view.byteLength < 16) return null;
  const n = view.getUint32(8, kLittle);
  const largest = view.getFloat32(12, kLittle);
  if (view.byteLength !== 16 + n || !Number.isFinite(largest)) return null;
  return {
    kind: "field",
    which: view.getUint8(1),
    version: view.getUint32(4, kLittle),
    largest,
    share: new Uint8Array(view.buffer.slice(16)),
  };
}

function triangles(view: DataView): Triangles | null {
  if (view.byteLength < 20) return null;
  const m = view.getUint32(8, kLittle);
  const k = view.getUint32(12, kLittle);
  const whole = view.getUint32(16, kLittle) === 1;
  const numbers = whole ? 0 : 4 * k;
  if (view.byteLength !== 20 + numbers + 12 * k || (whole && k !== m)) return null;
  const places = whole ? null : u32(view, 20, k);
  if (places?.some((place) => place >= m)) return null;
  return { kind: "triangles", version: view.getUint32(4, kLittle), m, places, corners: u32(view, 20 + numbers, 3 * k) };
}

/** A triangles message that names all of them. */
export function encode_triangles(version: number, corners: Uint32Array): ArrayBuffer {
  const bytes = new ArrayBuffer(20 + 4 * corners.length);
  const view = new DataView(bytes);
  view.setUint8(0, 6);
  view.setUint32(4, version, kLittle);
  view.setUint32(8, corners.length / 3, kLittle);
  view.setUint32(12, corners.length / 3, kLittle);
  view.setUint32(16, 1, kLittle);
  new Uint32Array(bytes, 20).set(corners);
  return bytes;
}

/** A surface message that names every vertex: what a recording begins its second with. */
export function encode_whole(version: number, step: number, t: number, q: Uint16Array): ArrayBuffer {
  const bytes = new ArrayBuffer(28 + 2 * q.length);
  const view = new DataView(bytes);
  view.setUint8(0, 2);
  view.setUint32(4, version, kLittle);
  view.setUint32(8, step, kLittle);
  view.setFloat64(12, t, kLittle);
  view.setUint32(20, q.length / 3, kLittle);
  view.setUint32(24, 1, kLittle);
  new Uint16Array(bytes, 28).set(q);
  return bytes;
}
