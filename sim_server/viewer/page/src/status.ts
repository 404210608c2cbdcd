// One word on how things stand: live, paused, recorded, or no connection and when it is tried again.
import type { Link } from "./connection";
import { by_id, set_text } from "./dom";
import type { Session } from "./session";

const kSilent = 2500; // ms without a message

export class Status {
  private link_: Link | "recorded" = "connecting";
  private again_ = 0; // ms, of performance.now
  private heard_ = 0;
  private readonly place_ = by_id("status");

  constructor(private readonly session_: Session) {}

  link(now: Link, seconds: number): void {
    if (now !== "connecting" || this.link_ !== "waiting") this.link_ = now; // an attempt is no news
    this.again_ = performance.now() + 1000 * seconds;
    if (now === "open") this.heard();
  }

  recorded(): void {
    this.link_ = "recorded";
  }

  heard(): void {
    this.heard_ = performance.now();
  }

  draw(now: number): void {
    const [kind, text] = this.words(now);
    this.place_.dataset.kind = kind;
    set_text(this.place_, text);
    const title = this.session_.scene?.title ?? "";
    set_text(by_id("title"), title);
    document.title = title ? `${title} \u00b7 Palpate` : "Palpate";
  }

  private words(now: number): [kind: string, text: string] {
    if (this.link_ === "recorded") return ["recorded", "Recorded"];
    if (this.link_ === "connecting") return ["waiting", "Connecting"];
    if (this.link_ === "waiting") {
      const seconds = Math.ceil(Math.max(0, this.again_ - now) / 1000);
      return ["lost", seconds > 0 ? `No server; trying again in ${seconds} s` : "No server; trying again"];
    }
    if (now - this.heard_ > kSilent) return ["lost", "The server is silent"];
    if (!this.session_.scene) return ["waiting", "Waiting for the scene"];
    return this.session_.state?.paused ? ["paused", "Paused"] : ["live", "Live"];
  }
}
