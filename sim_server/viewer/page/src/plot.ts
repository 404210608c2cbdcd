// One plot against time: lines, and impulses beneath them as in Picinbono and Lombardo's (1999) figure.
import uPlot from "uplot";
import { nice_above } from "./colours";
import { missed_times } from "./series";
import { colour_of } from "./theme";

export interface Line {
  label: string;
  colour: string;
  width: number;
  shown: boolean;
}

export interface Impulses {
  times: (number | null)[];
  values: (number | null)[];
  missed: (number | null)[]; // how many came just before, of which only that is known
  colour: string;
}

export type Columns = (number | null)[][];

const kFont = '11px "Inter", "Segoe UI", system-ui, sans-serif';

export class Plot {
  impulses: Impulses | null = null;
  /** The row under the mouse; null: none. */
  on_cursor: ((row: number | null) => void) | null = null;
  on_click: ((t: number) => void) | null = null;
  private plot_: uPlot | null = null;
  private key_ = "";
  private lines_: Line[] = [];
  private data_: Columns = [[]];
  private from_ = 0;
  private to_ = 1;

  constructor(private readonly host_: HTMLElement, private readonly least_: number, private readonly group_: string) {
    new ResizeObserver(() => this.fit()).observe(host_);
  }

  /** New numbers: times, then a column for each line; from and to in s. */
  set(lines: Line[], data: Columns, from: number, to: number): void {
    this.data_ = data;
    this.host_.classList.toggle("empty", data[0].length === 0 && !this.impulses?.times.length);
    this.from_ = from;
    this.to_ = to;
    const key = JSON.stringify(lines);
    if (key !== this.key_) {
      this.key_ = key;
      this.lines_ = lines;
      this.build();
    } else {
      this.plot_?.setData(data as uPlot.AlignedData, true);
    }
  }

  /** After the colours changed. */
  forget(): void {
    this.key_ = "";
  }

  private fit(): void {
    const { clientWidth: width, clientHeight: height } = this.host_;
    if (width > 0 && height > 0) this.plot_?.setSize({ width, height });
  }

  private build(): void {
    this.plot_?.destroy();
    const axis = colour_of("--muted");
    const grid = colour_of("--grid");
    const common: uPlot.Axis = { stroke: axis, font: kFont, ticks: { show: false }, grid: { stroke: grid, width: 1 } };
    const options: uPlot.Options = {
      width: Math.max(80, this.host_.clientWidth),
      height: Math.max(60, this.host_.clientHeight),
      padding: [6, 12, 0, 0],
      legend: { show: false },
      cursor: {
        y: false,
        drag: { x: false, y: false },
        points: { size: 6 },
        sync: { key: this.group_, setSeries: false, scales: ["x", null] },
      },
      scales: {
        x: { time: false, range: () => [this.from_, this.to_] },
        y: { range: (_plot, low, high) => this.range(low, high) },
      },
      axes: [
        { ...common, size: 22, gap: 3, space: 50, values: (_p, ticks) => ticks.map((t) => `${trim(t)} s`) },
        { ...common, size: 38, gap: 4, space: 26, values: (_p, ticks) => ticks.map(trim) },
      ],
      series: [{}, ...this.lines_.map(series)],
      hooks: {
        drawAxes: [(plot) => this.draw_impulses(plot)],
        setCursor: [(plot) => this.on_cursor?.(plot.cursor.idx ?? null)],
        ready: [(plot) => this.listen(plot)],
      },
    };
    this.plot_ = new uPlot(options, this.data_ as uPlot.AlignedData, this.host_);
  }

  private listen(plot: uPlot): void {
    plot.over.addEventListener("click", () => {
      const { left } = plot.cursor;
      if (left !== undefined && left >= 0) this.on_click?.(plot.posToVal(left, "x"));
    });
  }

  private range(low: number | null, high: number | null): [number, number] {
    let most = Math.max(high ?? 0, this.least_);
    for (const value of this.impulses?.values ?? []) most = Math.max(most, value ?? 0);
    const least = Math.min(0, low ?? 0);
    return [least < 0 ? -nice_above(-least) : 0, nice_half_above(most)];
  }

  private draw_impulses(plot: uPlot): void {
    if (!this.impulses) return;
    const { times, values, colour } = this.impulses;
    const { ctx, bbox } = plot;
    const zero = plot.valToPos(0, "y", true);
    const dot = 2 * devicePixelRatio;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.strokeStyle = ctx.fillStyle = colour;
    ctx.lineWidth = devicePixelRatio;
    ctx.beginPath();
    times.forEach((t, i) => {
      if (t === null || values[i] === null) return;
      const x = Math.round(plot.valToPos(t, "x", true)) + 0.5;
      const y = plot.valToPos(values[i]!, "y", true);
      ctx.moveTo(x, zero);
      ctx.lineTo(x, y);
      ctx.moveTo(x + dot, y);
      ctx.arc(x, y, dot, 0, 2 * Math.PI);
    });
    ctx.globalAlpha = 0.85;
    ctx.stroke();
    ctx.fill();
    ctx.beginPath();
    for (const t of missed_times(this.impulses.times, this.impulses.missed)) {
      const x = plot.valToPos(t, "x", true);
      ctx.moveTo(x + dot, zero - dot);
      ctx.arc(x, zero - dot, dot, 0, 2 * Math.PI);
    }
    ctx.stroke();
    ctx.restore();
  }
}

function series({ label, colour, width, shown }: Line): uPlot.Series {
  return { label, stroke: colour, width, show: shown, points: { show: false } };
}

/** 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten, not below x. */
function nice_half_above(x: number): number {
  const top = nice_above(x);
  const power = 10 ** Math.floor(Math.log10(x));
  return [1, 1.5, 2, 3, 4, 5, 6, 8].map((step) => step * power).find((value) => value >= x * (1 - 1e-9)) ?? top;
}

function trim(value: number): string {
  return String(Number(value.toPrecision(6)));
}
