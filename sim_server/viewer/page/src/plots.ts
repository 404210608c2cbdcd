// The plots of a session: force with its samples and every scored law; error; age; period; step time. One list of laws
// names their colours, shows the newest numbers (or those under the mouse), and hides a law that is clicked.
import { by_id, fixed, make } from "./dom";
import { type Columns, type Line, Plot } from "./plot";
import type { Session, ToolSeries } from "./session";
import { colour_of, law_colour, wants_little_motion } from "./theme";

const kMostRows = 2500;
const kPeriod = 66; // ms between two drawings

export class Plots {
  seconds = 5;
  tool = 0;
  private readonly force_ = new Plot(by_id("plot-force"), 0.02, "time");
  private readonly error_ = new Plot(by_id("plot-error"), 1, "time");
  private readonly age_ = new Plot(by_id("plot-age"), 1, "time");
  private readonly period_ = new Plot(by_id("plot-period"), 0.1, "time");
  private readonly step_ = new Plot(by_id("plot-step"), 1, "time");
  private readonly laws_ = by_id("laws");
  private hidden_ = new Set<string>();
  private chips_: HTMLElement[] = [];
  private chips_key_ = "";
  private data_: Columns = [[]];
  private row_: number | null = null;
  private stale_ = true;
  private drawn_ = 0;

  constructor(private readonly session_: Session, seek: (t: number) => void) {
    session_.listen(() => (this.stale_ = true));
    for (const plot of this.all()) plot.on_click = seek;
    this.force_.on_cursor = (row) => {
      this.row_ = row;
      this.show_values();
    };
  }

  invalidate(): void {
    this.stale_ = true;
  }

  theme(): void {
    for (const plot of this.all()) plot.forget();
    this.chips_key_ = "";
    this.stale_ = true;
  }

  draw(now: number): void {
    if (!this.stale_ || now - this.drawn_ < kPeriod) return;
    this.stale_ = false;
    this.drawn_ = now;
    const end = wants_little_motion() ? Math.ceil(this.session_.t) : this.session_.t;
    const to = Math.max(end, this.seconds);
    const from = to - this.seconds;
    const series = this.session_.tools.get(this.tool);
    this.make_chips(series);
    this.draw_force(series, from, to);
    const names = series?.laws ?? [];
    const errors = names.map((name) => this.line(name, law_colour(name), 1.5));
    this.error_.set(errors, series ? series.errors.since(from, kMostRows) : [[]], from, to);
    const loop = series ? series.loop.since(from, kMostRows) : [[], [], []];
    const ink = colour_of("--ink");
    this.age_.set([this.line("age", ink, 1.5)], [loop[0], loop[1]], from, to);
    this.period_.set([this.line("period", ink, 1.5)], [loop[0], loop[2]], from, to);
    this.step_.set([this.line("step time", ink, 1.5)], this.session_.steps.since(from, kMostRows), from, to);
  }

  private draw_force(series: ToolSeries | undefined, from: number, to: number): void {
    const columns = series ? series.ticks.since(from, kMostRows) : [[], []];
    const [times, felt, ...laws] = columns;
    const samples = series ? series.samples.since(from, 1000) : [[], [], []];
    this.force_.impulses = this.hidden_.has("samples")
      ? null
      : { times: samples[0], values: samples[1], missed: samples[2], colour: colour_of("--sample") };
    const names = laws.map((_, i) => series?.laws[i] ?? `law ${i + 1}`);
    const lines = names.map((name) => this.line(name, law_colour(name), 1.25));
    this.data_ = [times, ...laws, felt];
    this.force_.set([...lines, this.line("felt", colour_of("--ink"), 2)], this.data_, from, to);
    this.show_values();
  }

  private line(label: string, colour: string, width: number): Line {
    return { label, colour, width, shown: !this.hidden_.has(label) };
  }

  private make_chips(series: ToolSeries | undefined): void {
    const laws = series?.laws ?? [];
    const names = series ? [...laws, "felt", "samples"] : [];
    const key = JSON.stringify([names, [...this.hidden_]]);
    if (key === this.chips_key_) return;
    this.chips_key_ = key;
    this.laws_.replaceChildren();
    this.chips_ = names.map((name, i) => {
      const colour = i < laws.length ? law_colour(name) : colour_of(name === "felt" ? "--ink" : "--sample");
      return this.chip(name, colour);
    });
  }

  private chip(name: string, colour: string): HTMLElement {
    const button = make("button", "chip");
    button.type = "button";
    button.setAttribute("aria-pressed", String(!this.hidden_.has(name)));
    const swatch = make("span", name === "samples" ? "swatch impulse" : "swatch");
    swatch.style.background = colour;
    if (name === "samples") button.title = "Forces that the server computed. A ring: it computed one that this page did not get.";
    const value = make("span", "value");
    button.append(swatch, make("span", "name", name.replaceAll("_", " ")), value);
    button.onclick = () => {
      if (!this.hidden_.delete(name)) this.hidden_.add(name);
      this.stale_ = true;
    };
    this.laws_.append(button);
    return value;
  }

  private show_values(): void {
    const row = this.row_ ?? this.data_[0].length - 1;
    this.chips_.forEach((chip, i) => {
      const value = i < this.data_.length - 1 ? this.data_[i + 1][row] : null;
      const text = value === null || value === undefined ? "" : fixed(value, 2);
      if (chip.textContent !== text) chip.textContent = text;
    });
  }

  private all(): Plot[] {
    return [this.force_, this.error_, this.age_, this.period_, this.step_];
  }
}
