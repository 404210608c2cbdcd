// Plays a recorded session: records of ../MESSAGES.md, applied to the session as if a server sent them. Time is an
// argument: whoever has a clock calls advance.
import { decode } from "./messages";
import type { Session } from "./session";

interface Entry {
  t: number; // s, never less than the one before
  kind: string; // the first key of a text; topology, all_triangles, triangles, whole, surface, ticks, sample, field
  text: boolean;
  at: number;
  length: number;
}

const kHeader = 16;
const kBinaryKinds = ["", "topology", "surface", "ticks", "sample", "field", "triangles"];
const kPlotSeconds = 30; // what a seek fills the plots with

export class Playback {
  readonly start: number;
  readonly end: number;
  readonly damaged: boolean; // the last record is cut short
  now: number;
  playing = false;
  speed = 1;
  private readonly entries_: Entry[];
  private next_ = 0; // the first entry that was not applied
  private scene_ = -1; // the entries whose scene and topology the session holds
  private topology_ = -1;

  constructor(private readonly bytes_: ArrayBuffer, private readonly session_: Session) {
    const { entries, damaged } = index(bytes_);
    this.entries_ = entries;
    this.damaged = damaged;
    const moving = entries.filter((e) => e.kind !== "scene" && e.kind !== "topology");
    this.start = moving.length ? moving[0].t : 0;
    this.end = moving.length ? moving[moving.length - 1].t : 0;
    this.now = this.start;
  }

  get empty(): boolean {
    return this.entries_.length === 0;
  }

  play(): void {
    if (this.now >= this.end) this.seek(this.start);
    this.playing = true;
  }

  /** Goes on by some seconds of real time; stops at the end. */
  advance(seconds: number): void {
    if (!this.playing) return;
    this.now = Math.min(this.end, this.now + seconds * this.speed);
    this.apply_until(this.now);
    if (this.now >= this.end) this.playing = false;
  }

  /** The next or the last step of the simulation. */
  step(by: 1 | -1): void {
    this.playing = false;
    const states = this.entries_.filter((e) => e.kind === "state");
    const steps = by > 0 ? states.filter((e) => e.t > this.now + 1e-9) : states.filter((e) => e.t < this.now - 1e-9);
    const found = by > 0 ? steps[0] : steps[steps.length - 1];
    if (found) this.seek(found.t);
  }

  seek(t: number): void {
    this.now = Math.min(this.end, Math.max(this.start, t));
    const stop = this.first_after(this.now);
    const scene = this.last_before(stop, (e) => e.kind === "scene");
    const topology = this.last_before(stop, (e) => e.kind === "topology");
    const whole = this.last_before(stop, (e) => e.kind === "whole");
    const triangles = this.last_before(whole < 0 ? stop : whole, (e) => e.kind === "all_triangles");
    const cut_from = triangles > topology ? triangles : topology;
    this.session_.reset();
    if (scene >= 0 && scene !== this.scene_) this.apply(scene);
    if (topology >= 0 && topology !== this.topology_) this.apply(topology);
    const from = this.first_after(this.now - kPlotSeconds);
    for (let i = Math.max(0, Math.min(from, cut_from < 0 ? stop : cut_from, whole < 0 ? stop : whole)); i < stop; i++) {
      const { kind } = this.entries_[i];
      const moves = kind === "whole" || kind === "surface" || kind === "field";
      const cuts = kind === "triangles" || kind === "all_triangles";
      const shown = moves ? i >= whole : cuts ? i >= cut_from : i >= from;
      if (shown && kind !== "scene" && kind !== "topology" && i > scene) this.apply(i);
    }
    this.next_ = stop;
  }

  private apply_until(t: number): void {
    while (this.next_ < this.entries_.length && this.entries_[this.next_].t <= t) this.apply(this.next_++);
  }

  private apply(i: number): void {
    const { kind, text, at, length } = this.entries_[i];
    if (kind === "scene") {
      this.scene_ = i;
      this.topology_ = -1;
    }
    if (kind === "topology") this.topology_ = i;
    if (kind === "triangles" || kind === "all_triangles") this.topology_ = -1; // that one stands no more
    const bytes = this.bytes_.slice(at, at + length);
    this.session_.apply(decode(text ? new TextDecoder().decode(bytes) : bytes));
  }

  private first_after(t: number): number {
    let low = 0;
    let high = this.entries_.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.entries_[middle].t <= t) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  private last_before(stop: number, wanted: (e: Entry) => boolean): number {
    let i = stop - 1;
    while (i >= 0 && !wanted(this.entries_[i])) i--;
    return i;
  }
}

function index(bytes: ArrayBuffer): { entries: Entry[]; damaged: boolean } {
  const view = new DataView(bytes);
  const entries: Entry[] = [];
  let at = 0;
  let t = -Infinity;
  while (at + kHeader <= bytes.byteLength) {
    const length = view.getUint32(at, true);
    const text = view.getUint8(at + 4) === 0;
    const time = view.getFloat64(at + 8, true);
    at += kHeader;
    if (at + length > bytes.byteLength || !Number.isFinite(time)) return { entries, damaged: true };
    t = Math.max(t, time);
    entries.push({ t, kind: kind_of(view, at, length, text), text, at, length });
    at += length;
  }
  return { entries, damaged: at !== bytes.byteLength };
}

function kind_of(view: DataView, at: number, length: number, text: boolean): string {
  if (text) {
    const start = new TextDecoder().decode(view.buffer.slice(at, at + Math.min(length, 40)) as ArrayBuffer);
    return /^\s*\{\s*"(\w+)"/.exec(start)?.[1] ?? "";
  }
  const kind = length > 0 ? (kBinaryKinds[view.getUint8(at)] ?? "") : "";
  if (kind === "triangles" && length >= 20 && view.getUint32(at + 16, true) === 1) return "all_triangles";
  return kind === "surface" && length >= 28 && view.getUint32(at + 24, true) === 1 ? "whole" : kind;
}
