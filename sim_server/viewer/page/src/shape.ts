// The organ's surface: at rest, now, and what can be measured on it. Plain arrays; nothing of the screen.
import type { Surface, Topology, Triangles } from "./messages";
import type { ToolNow } from "./text_messages";

export class Shape {
  readonly n: number;
  m: number;
  readonly q: Uint16Array; // 3n, as sent
  readonly p: Float32Array; // 3n, m
  readonly normals: Float32Array; // 3n, unit, outward
  used: Uint8Array; // whether a vertex is of a triangle: others are inside, or gone
  known = false; // whether a surface message has come since the topology
  step = 0;
  t = 0;
  private metric_: Float32Array; // 4m: of each triangle at rest, the inverse metric (3) and the area, m2

  constructor(public topology: Topology) {
    this.n = topology.rest.length / 3;
    this.m = topology.corners.length / 3;
    this.q = new Uint16Array(3 * this.n);
    this.p = topology.rest.slice();
    this.normals = new Float32Array(3 * this.n);
    this.metric_ = rest_metric(topology);
    this.used = used_by(topology);
    this.update_normals();
  }

  /** Takes a surface message, or says no: of another topology, of vertices that are not here, or the first not whole. */
  move(surface: Surface): boolean {
    const k = surface.q.length / 3;
    if (surface.version !== this.topology.version) return false;
    if (surface.vertices ? !this.known || surface.vertices.some((v) => v >= this.n) : k !== this.n) return false;
    if (surface.vertices) {
      for (let i = 0; i < k; i++) this.q.set(surface.q.subarray(3 * i, 3 * i + 3), 3 * surface.vertices[i]);
    } else {
      this.q.set(surface.q);
    }
    const { box_min, box_size } = this.topology;
    for (let i = 0; i < this.q.length; i++) this.p[i] = box_min[i % 3] + (box_size[i % 3] * this.q[i]) / 65535;
    this.known = true;
    this.step = surface.step;
    this.t = surface.t;
    return true;
  }

  /** Takes other triangles of the same vertices, or says no: of vertices, or in places, that are not here. */
  cut(triangles: Triangles): boolean {
    const had = this.topology.corners;
    if (triangles.places && triangles.m > had.length / 3 + triangles.places.length) return false;
    const corners = new Uint32Array(3 * triangles.m);
    if (triangles.corners.some((v) => v >= this.n)) return false;
    if (triangles.places) {
      corners.set(had.subarray(0, Math.min(had.length, corners.length)));
      triangles.places.forEach((place, i) => corners.set(triangles.corners.subarray(3 * i, 3 * i + 3), 3 * place));
    } else {
      corners.set(triangles.corners);
    }
    this.topology = { ...this.topology, version: triangles.version, corners };
    this.m = triangles.m;
    this.metric_ = rest_metric(this.topology);
    this.used = used_by(this.topology);
    this.update_normals();
    return true;
  }

  update_normals(): void {
    const { p, normals } = this;
    const corners = this.topology.corners;
    normals.fill(0);
    for (let i = 0; i < corners.length; i += 3) {
      const a = 3 * corners[i], b = 3 * corners[i + 1], c = 3 * corners[i + 2];
      const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
      const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
      const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
      for (const at of [a, b, c]) {
        normals[at] += x;
        normals[at + 1] += y;
        normals[at + 2] += z;
      }
    }
    for (let i = 0; i < normals.length; i += 3) {
      const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) || 1;
      normals[i] /= length;
      normals[i + 1] /= length;
      normals[i + 2] /= length;
    }
  }

  /** How far each vertex is from where it rests, m. */
  displacement(out: Float32Array): void {
    const { p } = this;
    const { rest } = this.topology;
    for (let i = 0; i < this.n; i++) {
      const j = 3 * i;
      out[i] = this.used[i] ? Math.hypot(p[j] - rest[j], p[j + 1] - rest[j + 1], p[j + 2] - rest[j + 2]) : 0;
    }
  }

  /** The larger principal stretch of the surface against rest, less 1; at a vertex the mean of its triangles by area. */
  stretch(out: Float32Array): void {
    const { p, metric_ } = this;
    const corners = this.topology.corners;
    const area = new Float32Array(this.n);
    out.fill(0);
    for (let i = 0; i < this.m; i++) {
      const a = corners[3 * i], b = corners[3 * i + 1], c = corners[3 * i + 2];
      const [g11, g12, g22] = metric(p, a, b, c);
      const h11 = metric_[4 * i], h12 = metric_[4 * i + 1], h22 = metric_[4 * i + 2], w = metric_[4 * i + 3];
      const half_trace = (h11 * g11 + 2 * h12 * g12 + h22 * g22) / 2;
      const det = (g11 * g22 - g12 * g12) * (h11 * h22 - h12 * h12);
      const largest = Math.sqrt(half_trace + Math.sqrt(Math.max(0, half_trace * half_trace - det)));
      for (const v of [a, b, c]) {
        out[v] += w * (largest - 1);
        area[v] += w;
      }
    }
    for (let i = 0; i < this.n; i++) out[i] = area[i] > 0 ? Math.max(0, out[i] / area[i]) : 0;
  }

  /** The tools' loads against the surface by a vertex's share of area, Pa: a third of each triangle around it. */
  pressure(out: Float32Array, tools: ToolNow[]): void {
    out.fill(0);
    const area = new Map<number, number>();
    for (const tool of tools) for (const [v] of tool.loads) if (v < this.n) area.set(v, 0);
    if (area.size === 0) return;
    const corners = this.topology.corners;
    for (let i = 0; i < corners.length; i += 3) {
      const a = corners[i], b = corners[i + 1], c = corners[i + 2];
      if (!area.has(a) && !area.has(b) && !area.has(c)) continue;
      const [g11, g12, g22] = metric(this.p, a, b, c);
      const third = Math.sqrt(Math.max(0, g11 * g22 - g12 * g12)) / 6;
      for (const v of [a, b, c]) if (area.has(v)) area.set(v, area.get(v)! + third);
    }
    for (const tool of tools) {
      for (const [v, x, y, z] of tool.loads) {
        const share = area.get(v);
        if (!share) continue;
        const inward = -(x * this.normals[3 * v] + y * this.normals[3 * v + 1] + z * this.normals[3 * v + 2]);
        out[v] += Math.max(0, inward) / share;
      }
    }
  }

  /** Each edge of the surface once, as pairs of vertices. */
  edges(): Uint32Array {
    const seen = new Set<number>();
    const { corners } = this.topology;
    for (let i = 0; i < corners.length; i++) {
      const a = corners[i], b = corners[i % 3 === 2 ? i - 2 : i + 1];
      seen.add(a < b ? a * this.n + b : b * this.n + a);
    }
    const out = new Uint32Array(2 * seen.size);
    let at = 0;
    for (const edge of seen) {
      out[at++] = Math.floor(edge / this.n);
      out[at++] = edge % this.n;
    }
    return out;
  }

  /** How far a place is from the surface, m. */
  distance(place: ArrayLike<number>): number {
    const { corners } = this.topology;
    let least = Infinity;
    for (let i = 0; i < corners.length; i += 3)
      least = Math.min(least, squared_to_triangle(this.p, corners[i], corners[i + 1], corners[i + 2], place));
    return Math.sqrt(least);
  }

  /** The vertex of the surface nearest to a place. */
  nearest(place: ArrayLike<number>): number {
    let vertex = -1;
    let least = Infinity;
    for (let i = 0; i < this.n; i++) {
      if (!this.used[i]) continue;
      const x = this.p[3 * i] - place[0], y = this.p[3 * i + 1] - place[1], z = this.p[3 * i + 2] - place[2];
      const squared = x * x + y * y + z * z;
      if (squared < least) {
        least = squared;
        vertex = i;
      }
    }
    return vertex;
  }
}

function metric(p: Float32Array, a: number, b: number, c: number): [number, number, number] {
  const ux = p[3 * b] - p[3 * a], uy = p[3 * b + 1] - p[3 * a + 1], uz = p[3 * b + 2] - p[3 * a + 2];
  const vx = p[3 * c] - p[3 * a], vy = p[3 * c + 1] - p[3 * a + 1], vz = p[3 * c + 2] - p[3 * a + 2];
  return [ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz, vx * vx + vy * vy + vz * vz];
}

/** Of a place from a triangle, m2: in the plane's coordinates along its edges, held within it (Ericson 2005, 5.1.5). */
function squared_to_triangle(p: Float32Array, a: number, b: number, c: number, place: ArrayLike<number>): number {
  const ux = p[3 * b] - p[3 * a], uy = p[3 * b + 1] - p[3 * a + 1], uz = p[3 * b + 2] - p[3 * a + 2];
  const vx = p[3 * c] - p[3 * a], vy = p[3 * c + 1] - p[3 * a + 1], vz = p[3 * c + 2] - p[3 * a + 2];
  const x = place[0] - p[3 * a], y = place[1] - p[3 * a + 1], z = place[2] - p[3 * a + 2];
  const uu = ux * ux + uy * uy + uz * uz, uv = ux * vx + uy * vy + uz * vz, vv = vx * vx + vy * vy + vz * vz;
  const du = x * ux + y * uy + z * uz, dv = x * vx + y * vy + z * vz;
  const away = (s: number, t: number) => (x - s * ux - t * vx) ** 2 + (y - s * uy - t * vy) ** 2 + (z - s * uz - t * vz) ** 2;
  const det = uu * vv - uv * uv;
  const s = (vv * du - uv * dv) / det, t = (uu * dv - uv * du) / det;
  if (det > 0 && s >= 0 && t >= 0 && s + t <= 1) return away(s, t);
  const clamp = (x: number) => (x > 0 ? Math.min(x, 1) : 0); // of what is no number, too
  const on_u = clamp(du / uu), on_v = clamp(dv / vv);
  const across = clamp((dv - du + uu - uv) / (uu - 2 * uv + vv)); // from b to c
  return Math.min(away(on_u, 0), away(0, on_v), away(1 - across, across));
}

function used_by({ rest, corners }: Topology): Uint8Array {
  const used = new Uint8Array(rest.length / 3);
  for (const vertex of corners) used[vertex] = 1;
  return used;
}

function rest_metric({ rest, corners }: Topology): Float32Array {
  const out = new Float32Array((4 * corners.length) / 3);
  for (let i = 0; i < corners.length / 3; i++) {
    const [g11, g12, g22] = metric(rest, corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]);
    const det = g11 * g22 - g12 * g12;
    if (det > 0) out.set([g22 / det, -g12 / det, g11 / det, Math.sqrt(det) / 2], 4 * i);
  }
  return out;
}
