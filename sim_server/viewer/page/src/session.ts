// The newest of everything that a page was told, from a live server or from a recording alike.
import type { Field, Message } from "./messages";
import { Series } from "./series";
import { Shape } from "./shape";
import type { Client, Scene, State } from "./text_messages";

const kTickRows = 1 << 16; // 16 s at 4 kHz, 130 s at 500 Hz
const kSlowRows = 1 << 12;

/** What is plotted of one tool. */
export interface ToolSeries {
  laws: string[];
  ticks: Series; // force felt, then each law, N
  samples: Series; // force computed, N; samples just before it that this page did not get
  errors: Series; // of each law, percent
  loop: Series; // age of the force, loop period, ms
}

export type Change = "scene" | "topology" | "cut" | "surface" | "state" | "client" | "ticks" | "field" | "refused" | "reset";
type Listener = (change: Change, message?: Message) => void;

export class Session {
  scene: Scene | null = null;
  state: State | null = null;
  clients = new Map<number, Client>();
  shape: Shape | null = null;
  field: Field | null = null;
  tools = new Map<number, ToolSeries>();
  steps = new Series(1, kSlowRows); // step time, ms
  t = 0; // s, of the newest message that has a time
  unreadable = 0;
  private readonly listeners_: Listener[] = [];

  listen(listener: Listener): void {
    this.listeners_.push(listener);
  }

  /** Forgets what the plots show, and the organ: before another session, or another place in a recording. */
  reset(): void {
    this.state = null;
    this.field = null;
    this.clients.clear();
    this.tools.clear();
    this.steps.clear();
    this.t = 0;
    this.tell("reset");
  }

  apply(message: Message | null): void {
    if (!message) {
      this.unreadable++;
      return;
    }
    const change = this.take(message);
    if (change) this.tell(change, message);
  }

  series(tool: number, laws = -1): ToolSeries {
    let found = this.tools.get(tool);
    if (!found || (laws >= 0 && found.ticks.columns !== laws + 1)) {
      const count = Math.max(0, laws);
      found = {
        laws: found?.laws ?? [],
        ticks: new Series(count + 1, kTickRows),
        samples: found?.samples ?? new Series(2, kSlowRows),
        errors: new Series(count, kSlowRows),
        loop: found?.loop ?? new Series(2, kSlowRows),
      };
      this.tools.set(tool, found);
    }
    return found;
  }

  private take(message: Message): Change | null {
    switch (message.kind) {
      case "scene":
        this.scene = message.scene;
        this.reset();
        this.shape = null;
        return "scene";
      case "topology":
        this.shape = message.rest.length > 0 ? new Shape(message) : null;
        this.field = null;
        return "topology";
      case "triangles":
        if (!this.shape?.cut(message)) return null;
        this.field = null;
        return "cut";
      case "surface":
        if (!this.shape?.move(message)) return null;
        this.t = Math.max(this.t, message.t);
        return "surface";
      case "field":
        if (message.version !== this.shape?.topology.version || message.share.length !== this.shape.n) return null;
        this.field = message;
        return "field";
      case "state":
        return this.take_state(message.state);
      case "client":
        message.clients.forEach((client) => this.take_client(client));
        return "client";
      case "ticks":
        return this.take_ticks(message);
      case "sample":
        this.series(message.tool).samples.push(message.t, [message.force, message.missed]);
        this.t = Math.max(this.t, message.t);
        return "ticks";
      case "refused":
        return "refused";
    }
  }

  private take_state(state: State): Change {
    if (this.state && state.step !== this.state.step && state.step_ms !== null) this.steps.push(state.t, [state.step_ms]);
    this.state = state;
    for (const tool of this.clients.keys()) if (!state.tools[tool]?.held) this.clients.delete(tool); // it left
    this.t = Math.max(this.t, state.t);
    return "state";
  }

  private take_client(client: Client): void {
    this.clients.set(client.tool, client);
    const series = this.series(client.tool, client.laws.length);
    series.laws = client.laws;
    series.errors.push(this.t, client.errors_percent.map((e) => e ?? NaN));
    series.loop.push(this.t, [client.age_ms ?? NaN, client.period_ms ?? NaN]);
  }

  private take_ticks(message: Extract<Message, { kind: "ticks" }>): Change {
    const { ticks } = this.series(message.tool, message.laws);
    const row = new Float32Array(message.laws + 1);
    message.felt.forEach((felt, i) => {
      row[0] = felt;
      row.set(message.by_law.subarray(i * message.laws, (i + 1) * message.laws), 1);
      ticks.push(message.t + i * message.dt, row);
    });
    this.t = Math.max(this.t, message.t + (message.felt.length - 1) * message.dt);
    return "ticks";
  }

  private tell(change: Change, message?: Message): void {
    for (const listener of this.listeners_) listener(change, message);
  }
}
