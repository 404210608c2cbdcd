// The buttons and lists of the page: what they may do now, and what they show.
import { by_id, clock, make, set_text } from "./dom";
import { list_keys } from "./keys";
import type { Playback } from "./playback";
import type { Session } from "./session";

export interface Does {
  pause(): void;
  step(by: 1 | -1): void;
  home(): void;
  picture(): void;
  video(): void;
  share(): void;
  choose(scene: string): void;
  tool(tool: number): void;
  seconds(seconds: number): void;
}

export class Controls {
  tool = 0;
  private playback_: Playback | null = null;
  private touched_ = false;
  private scenes_key_ = "";
  private readonly pause_ = by_id<HTMLButtonElement>("pause");
  private readonly step_ = by_id<HTMLButtonElement>("step");
  private readonly scenes_ = by_id<HTMLSelectElement>("scenes");
  private readonly scrubber_ = by_id<HTMLInputElement>("scrubber");

  constructor(private readonly session_: Session, private readonly does_: Does) {
    this.pause_.onclick = () => does_.pause();
    this.step_.onclick = () => does_.step(1);
    for (const name of ["home", "picture", "video", "share"] as const) by_id(name).onclick = () => does_[name]();
    const keys = by_id<HTMLDialogElement>("keys");
    by_id("help").onclick = () => keys.showModal();
    list_keys(by_id("key-list"));
    this.scenes_.onchange = () => {
      does_.choose(this.scenes_.value);
      this.scenes_key_ = ""; // until that scene is there, the list shows the one that is
    };
    const seconds = by_id<HTMLSelectElement>("seconds");
    seconds.onchange = () => does_.seconds(Number(seconds.value));
    by_id("picture-canvas").addEventListener("pointerdown", () => (this.touched_ = true));
  }

  pausable(): boolean {
    const { scene } = this.session_;
    return scene !== null && scene.control && scene.pausable;
  }

  /** The tools that this page may move: those whose client listens to a page; all, while no client has said. */
  touchable(): number[] {
    const { scene, state, clients } = this.session_;
    if (!scene?.control || this.playback_) return [];
    const all = scene.tools.map((_, i) => i).filter((i) => state?.tools[i]?.held);
    return all.filter((i) => (clients.get(i)?.device ?? "browser") === "browser");
  }

  recorded(playback: Playback): void {
    this.playback_ = playback;
    by_id("playback").hidden = false;
    this.pause_.hidden = this.step_.hidden = by_id("share").hidden = true;
    by_id("back").onclick = () => this.does_.step(-1);
    by_id("forth").onclick = () => this.does_.step(1);
    this.scrubber_.max = String(Math.round(1000 * (playback.end - playback.start)));
    this.scrubber_.oninput = () => playback.seek(playback.start + Number(this.scrubber_.value) / 1000);
    by_id("play").onclick = () => this.does_.pause();
    const speed = by_id<HTMLSelectElement>("speed");
    speed.onchange = () => (playback.speed = Number(speed.value));
  }

  filming(running: boolean): void {
    const video = by_id("video");
    video.setAttribute("aria-pressed", String(running));
    video.textContent = running ? "Stop video" : "Video";
  }

  draw(): void {
    const { scene, state } = this.session_;
    const playback = this.playback_;
    const paused = playback ? !playback.playing : state?.paused === true;
    this.pause_.disabled = !playback && !this.pausable();
    this.step_.disabled = this.pause_.disabled || !paused;
    set_text(this.pause_, paused ? (playback ? "Play" : "Go on") : "Pause");
    by_id("scenes-label").hidden = !scene?.control || scene.scenes.length === 0;
    this.list_scenes(scene?.scenes ?? [], scene?.file ?? "");
    this.list_tools(scene?.tools.length ?? 0);
    const hint = this.touchable().length > 0 && !this.touched_;
    by_id("hint").hidden = !hint;
    if (hint) set_text(by_id("hint"), "Drag on the organ to touch it; the wheel is depth.");
    if (!playback) return;
    by_id("no-organ").hidden = this.session_.shape !== null || state === null;
    set_text(by_id("play"), paused ? "Play" : "Pause");
    const place = playback.now - playback.start;
    if (document.activeElement !== this.scrubber_ || playback.playing) this.scrubber_.value = String(Math.round(1000 * place));
    const text = `${clock(place)} of ${clock(playback.end - playback.start)}`;
    set_text(by_id("place"), text);
    this.scrubber_.setAttribute("aria-valuetext", text);
  }

  private list_scenes(names: string[], file: string): void {
    const key = JSON.stringify([names, file]);
    if (key === this.scenes_key_) return;
    this.scenes_key_ = key;
    const now = file.replace(/^.*\//, "").replace(/\.toml$/, "");
    const options = names.map((name) => new Option(name.replaceAll("_", " "), name));
    if (!names.includes(now)) options.unshift(new Option(now || "other", ""));
    this.scenes_.replaceChildren(...options);
    this.scenes_.value = names.includes(now) ? now : "";
  }

  private list_tools(count: number): void {
    const place = by_id("tools");
    place.hidden = count < 2;
    if (place.childElementCount !== count) {
      const buttons = Array.from({ length: count }, (_, i) => {
        const button = make("button", "", `Tool ${i + 1}`);
        button.type = "button";
        button.onclick = () => this.does_.tool(i);
        return button;
      });
      place.replaceChildren(...buttons);
    }
    [...place.children].forEach((button, i) => button.setAttribute("aria-pressed", String(i === this.tool)));
  }
}
