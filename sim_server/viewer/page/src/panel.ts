// The numbers: the few that matter most in large type, and the whole list beneath the plots.
import { by_id, figures, fixed, kNone, make, set_text } from "./dom";
import type { Session } from "./session";
import type { Client, Resected, State } from "./text_messages";

type Row = [name: string, value: string, unit: string];

const kPeriod = 120; // ms between two drawings: digits that one can read

export class Panel {
  tool = 0;
  private readonly rows_ = new Map<string, { value: HTMLElement; unit: HTMLElement }>();
  private keys_ = "";
  private stale_ = true;
  private drawn_ = 0;

  /** `frame_rate`: pictures drawn, Hz. */
  constructor(private readonly session_: Session, private readonly frame_rate_: () => number | null) {
    session_.listen(() => (this.stale_ = true));
  }

  invalidate(): void {
    this.stale_ = true;
  }

  draw(now: number): void {
    if (!this.stale_ || now - this.drawn_ < kPeriod) return;
    this.stale_ = false;
    this.drawn_ = now;
    this.large();
    const groups: [string, Row[]][] = [["Simulation", this.simulation()], [`Tool ${this.tool + 1}`, this.tool_rows()]];
    const cut = this.session_.state?.resection;
    if (cut) groups.push(["Resection", resection_rows(cut)]);
    const client = this.session_.clients.get(this.tool);
    groups.push(["Error of the force", this.error_rows(client)]);
    if (client) groups.push(["Client", client_rows(client)], ["Safety", safety_rows(client)]);
    this.list(groups);
  }

  private large(): void {
    const { state } = this.session_;
    const client = this.session_.clients.get(this.tool);
    const now = state?.tools[this.tool];
    const felt = now?.held ? (client?.felt ?? now.f) : null;
    set_text(by_id("big-force"), felt ? fixed(Math.hypot(...felt), 2) : kNone);
    set_text(by_id("big-force-name"), client?.felt ? "Force felt" : "Force");
    set_text(by_id("big-age"), fixed(client?.age_ms, 0));
    set_text(by_id("big-step"), figures(state?.step_ms));
    set_text(by_id("big-factor"), fixed(state?.real_time_factor, 2));
  }

  private simulation(): Row[] {
    const { scene, state } = this.session_;
    if (!scene) return [];
    return [
      ["Scene", scene.title || kNone, ""],
      ["File", scene.file || kNone, ""],
      ["Model", scene.model.replaceAll("_", " ") || kNone, ""],
      ["Rate asked for", scene.rate_hz > 0 ? plain(scene.rate_hz) : "as fast as it can", scene.rate_hz > 0 ? "Hz" : ""],
      ["Rate", figures(state?.rate_hz), "Hz"],
      ["Step", state ? String(state.step) : kNone, ""],
      ["Pictures drawn", fixed(this.frame_rate_(), 0), "Hz"],
      ["Late steps", state?.late != null ? String(state.late) : kNone, ""],
    ];
  }

  private tool_rows(): Row[] {
    const { state, shape } = this.session_;
    const now = state?.tools[this.tool];
    const rows: Row[] = [["Held", held(state, this.tool), ""]];
    if (now?.held) {
      rows.push(["Contact", now.contact ? "yes" : "no", ""]);
      rows.push(["Place x, y, z", now.p.map((x) => fixed(1e3 * x, 1)).join("  "), "mm"]);
      if (shape) {
        const radius = this.session_.scene?.tools[this.tool]?.radius ?? 0;
        rows.push(["Tip to organ", now.contact ? "0.0" : fixed(1e3 * Math.max(0, shape.distance(now.p) - radius), 1), "mm"]);
      }
      rows.push(["Force computed", fixed(Math.hypot(...now.f), 2), "N"]);
      if (now.flagged) rows.push(["Server says", "no force: this step is flagged", ""]);
    }
    for (const peer of state?.peers ?? []) {
      if (peer.tool !== this.tool) continue;
      rows.push(["Peer", peer.address || kNone, ""], ["Datagrams lost", figures(peer.loss_percent), "%"]);
      rows.push(["Tool states", figures(peer.rate_hz), "Hz"]);
    }
    return rows;
  }

  /** All that is known of it: no small error stands without the large one beside it. */
  private error_rows(client: Client | undefined): Row[] {
    const now = this.session_.state?.tools[this.tool];
    if (!now?.held) {
      set_text(by_id("error-beside"), "");
      return [];
    }
    const { mesh, time_step } = now;
    set_text(by_id("error-beside"), mesh.percent === null ? "mesh not known" : `mesh ${figures(mesh.percent)} % ${mesh.source}`);
    const parts: Row[] = (client?.parts_percent ?? []).map(([name, percent]) => [sentence(name), figures(percent), "%"]);
    return [
      ["Force on the hand", figures(client?.total_percent ?? null), "% at most, in the mean"],
      ["Mesh", figures(mesh.percent), `% ${mesh.source}`],
      ["Time step", figures(time_step.percent), `% ${time_step.source}`],
      ...parts,
      ["Law of the tissue", this.session_.state?.strain || "not known", ""],
      ["Not settled", String(now.flagged_samples), now.flagged_samples === 1 ? "sample of the server" : "samples of the server"],
      ["Age of the force", fixed(client?.age_ms, 0), "ms"],
      ["Beside a hand", client?.beside || kNone, ""],
    ];
  }

  private list(groups: [string, Row[]][]): void {
    const keys = groups.map(([group, rows]) => group + rows.map((row) => row[0]).join()).join();
    if (keys !== this.keys_) {
      this.keys_ = keys;
      this.rows_.clear();
      by_id("numbers").replaceChildren(...groups.filter(([, rows]) => rows.length).map((group) => this.group(...group)));
    }
    for (const [group, rows] of groups) {
      for (const [name, value, unit] of rows) {
        const row = this.rows_.get(group + name)!;
        set_text(row.value, value);
        set_text(row.unit, value === kNone ? "" : unit);
      }
    }
  }

  private group(title: string, rows: Row[]): HTMLElement {
    const section = make("section");
    const list = make("dl");
    for (const [name] of rows) {
      const value = make("span");
      const unit = make("span", "unit");
      const cell = make("dd");
      cell.append(value, unit);
      list.append(make("dt", "", name), cell);
      this.rows_.set(title + name, { value, unit });
    }
    section.append(make("h3", "", title), list);
    return section;
  }
}

function plain(value: number): string {
  return String(Number(value.toPrecision(4)));
}

function held(state: State | null, tool: number): string {
  const now = state?.tools[tool];
  return now ? (now.held ? "yes" : "by nobody") : kNone;
}

function resection_rows(cut: Resected): Row[] {
  return [
    ["Removed", fixed(1e6 * cut.volume, 2), "ml"],
    ["Tetrahedra gone", String(cut.tetrahedra), ""],
    ["Cut, both sides", fixed(1e4 * cut.cut_area, 1), "cm\u00b2"],
    ["From the plan, mean", millimetres(cut.mean_distance), "mm"],
    ["From the plan, farthest", millimetres(cut.farthest), "mm"],
    ["Parted, from the plan", millimetres(cut.mean_parted_distance), "mm"],
    ["Pieces cut loose", String(cut.loose_pieces), ""],
  ];
}

function millimetres(metres: number | null): string {
  return fixed(metres === null ? null : 1e3 * metres, 1);
}

function client_rows(client: Client): Row[] {
  return [
    ["Device", client.device.replaceAll("_", " ") || kNone, client.has_motors ? "with motors" : ""],
    ["Law felt", client.law.replaceAll("_", " ") || kNone, ""],
    ["Age of force", fixed(client.age_ms, 1), "ms"],
    ["Loop period", figures(client.period_ms), "ms"],
    ["Missed ticks", client.missed === null ? kNone : String(client.missed), ""],
  ];
}

function safety_rows(client: Client): Row[] {
  const counts: Row[] = client.interventions.map(([name, count]) => [sentence(name), String(count), ""]);
  const now = client.states.map((state) => state.replaceAll("_", " ")).join(", ");
  return [["Now", now || "as usual", ""], ["Passivity gain", fixed(client.passivity_gain, 2), ""], ...counts];
}

function sentence(name: string): string {
  const words = name.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}
