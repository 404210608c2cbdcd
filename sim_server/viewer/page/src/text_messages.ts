// The text messages of ../MESSAGES.md. What a message lacks, or gives in another type, becomes null, 0, false or empty:
// the page then shows a dash, and goes on.
import type { Message } from "./messages";

export type Vec3 = [number, number, number];

export interface ToolShape {
  shape: "sphere" | "capsule";
  radius: number; // m
  length: number; // m, of a capsule; 0: none
  trocar: Vec3 | null; // m: the place in the body wall about which it turns
  shaft_radius: number | null; // m, of an instrument with a trocar
  axis: Vec3 | null; // of the shaft, in the tool's frame
}

export interface Scene {
  title: string;
  file: string;
  model: string;
  rate_hz: number; // 0: as fast as the model allows
  scenes: string[];
  tools: ToolShape[];
  control: boolean;
  pausable: boolean;
  recorded: boolean;
  blades: boolean; // whether a blade may part the organ
  fields: string[];
}

/** Of the force, % of its root mean square. */
export interface Discretisation {
  percent: number | null;
  source: string; // such as "estimated"
}

export interface ToolNow {
  held: boolean;
  p: Vec3; // m
  q: [number, number, number, number]; // w, x, y, z
  f: Vec3; // N, on the tool
  contact: boolean;
  flagged: boolean;
  flagged_samples: number; // of its client so far
  mesh: Discretisation;
  time_step: Discretisation;
  loads: [number, number, number, number][]; // vertex; N, on the organ
}

/** What has been cut away: m3, m2 of both sides, m from the plan; null: there is none, or nothing was cut so. */
export interface Resected {
  tetrahedra: number;
  volume: number;
  cut_area: number;
  mean_distance: number | null;
  farthest: number | null;
  mean_parted_distance: number | null;
  loose_pieces: number;
}

export interface State {
  t: number; // s
  step: number;
  paused: boolean;
  step_ms: number | null;
  late: number | null;
  rate_hz: number | null;
  real_time_factor: number | null;
  tools: ToolNow[];
  resection: Resected | null;
  strain: string; // beyond what the tissue's law means, in words; empty: nowhere
  peers: { tool: number; address: string; loss_percent: number | null; rate_hz: number | null }[];
}

export interface Client {
  tool: number;
  law: string;
  laws: string[];
  errors_percent: (number | null)[];
  total_percent: number | null;
  parts_percent: [string, number | null][]; // of that error, by their names in the client's report
  beside: string; // the age of the force beside what a hand can tell
  age_ms: number | null;
  period_ms: number | null;
  missed: number | null;
  passivity_gain: number | null;
  interventions: [string, number][];
  felt: Vec3 | null; // N
  p: Vec3 | null; // m
  device: string;
  has_motors: boolean;
  states: string[]; // such as "clutched", "fading", "fault", "device lost"
}

type Json = Record<string, unknown>;

export function decode_text(text: string): Message | null {
  let json: unknown;
  try {
    json = JSON.parse(text);
  } catch {
    return null;
  }
  if (!is_object(json)) return null;
  if (is_object(json.scene)) return { kind: "scene", scene: scene(json.scene) };
  if (is_object(json.state)) return { kind: "state", state: state(json.state) };
  if (Array.isArray(json.client)) return { kind: "client", clients: json.client.filter(is_object).map(client) };
  if (is_object(json.client)) return { kind: "client", clients: [client(json.client)] };
  if (typeof json.refused === "string") return { kind: "refused", why: json.refused };
  return null;
}

function is_object(x: unknown): x is Json {
  return typeof x === "object" && x !== null && !Array.isArray(x);
}

function number(x: unknown): number | null {
  return typeof x === "number" && Number.isFinite(x) ? x : null;
}

function text(x: unknown): string {
  return typeof x === "string" ? x : "";
}

function list(x: unknown): unknown[] {
  return Array.isArray(x) ? x : [];
}

function vec3(x: unknown): Vec3 | null {
  return Array.isArray(x) && x.length === 3 && x.every((v) => number(v) !== null) ? (x as Vec3) : null;
}

function scene(x: Json): Scene {
  return {
    title: text(x.title),
    file: text(x.file),
    model: text(x.model),
    rate_hz: number(x.rate_hz) ?? 0,
    scenes: list(x.scenes).map(text).filter(Boolean),
    tools: list(x.tools).filter(is_object).map(tool_shape),
    control: x.control === true,
    pausable: x.pausable === true,
    recorded: x.recorded === true,
    blades: x.blades === true,
    fields: list(x.fields).map(text),
  };
}

function tool_shape(x: Json): ToolShape {
  return {
    shape: x.shape === "capsule" ? "capsule" : "sphere",
    radius: number(x.radius) ?? 0.005,
    length: number(x.length) ?? 0,
    trocar: vec3(x.trocar),
    shaft_radius: number(x.shaft_radius),
    axis: vec3(x.axis),
  };
}

function state(x: Json): State {
  return {
    t: number(x.t) ?? 0,
    step: number(x.step) ?? 0,
    paused: x.paused === true,
    step_ms: number(x.step_ms),
    late: number(x.late),
    rate_hz: number(x.rate_hz),
    real_time_factor: number(x.real_time_factor),
    tools: list(x.tools).filter(is_object).map(tool_now),
    resection: is_object(x.resection) ? resected(x.resection) : null,
    strain: text(x.strain),
    peers: list(x.peers).filter(is_object).map((peer) => ({
      tool: number(peer.tool) ?? 0,
      address: text(peer.address),
      loss_percent: number(peer.loss_percent),
      rate_hz: number(peer.rate_hz),
    })),
  };
}

function resected(x: Json): Resected {
  return {
    tetrahedra: number(x.tetrahedra) ?? 0,
    volume: number(x.volume) ?? 0,
    cut_area: number(x.cut_area) ?? 0,
    mean_distance: number(x.mean_distance),
    farthest: number(x.farthest),
    mean_parted_distance: number(x.mean_parted_distance),
    loose_pieces: number(x.loose_pieces) ?? 0,
  };
}

function discretisation(x: unknown): Discretisation {
  return is_object(x) ? { percent: number(x.percent), source: text(x.source) } : { percent: null, source: "" };
}

function tool_now(x: Json): ToolNow {
  const errors = is_object(x.errors) ? x.errors : {};
  const q = list(x.q);
  const turned = q.length === 4 && q.every((v) => number(v) !== null);
  const loads = list(x.loads).filter((l) => Array.isArray(l) && l.length === 4 && l.every((v) => number(v) !== null));
  return {
    held: x.held === true,
    p: vec3(x.p) ?? [0, 0, 0],
    q: turned ? (q as ToolNow["q"]) : [1, 0, 0, 0],
    f: vec3(x.f) ?? [0, 0, 0],
    contact: x.contact === true,
    flagged: x.flagged === true,
    flagged_samples: number(x.flagged_samples) ?? 0,
    mesh: discretisation(errors.mesh),
    time_step: discretisation(errors.time_step),
    loads: loads as ToolNow["loads"],
  };
}

function client(x: Json): Client {
  const counts = is_object(x.interventions) ? Object.entries(x.interventions) : [];
  const parts = is_object(x.parts_percent) ? Object.entries(x.parts_percent) : [];
  return {
    tool: number(x.tool) ?? 0,
    law: text(x.law),
    laws: list(x.laws).map(text),
    errors_percent: list(x.errors_percent).map(number),
    total_percent: number(x.total_percent),
    parts_percent: parts.map(([name, percent]) => [name, number(percent)]),
    beside: text(x.beside),
    age_ms: number(x.age_ms),
    period_ms: number(x.period_ms),
    missed: number(x.missed),
    passivity_gain: number(x.passivity_gain),
    interventions: counts.map(([name, count]) => [name, number(count) ?? 0]),
    felt: vec3(x.felt),
    p: vec3(x.p),
    device: text(x.device),
    has_motors: x.has_motors === true,
    states: list(x.states).map(text).filter(Boolean),
  };
}
