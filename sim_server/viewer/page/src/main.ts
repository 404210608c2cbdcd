// Puts the page together: a session, fed by a server or by a recording; the picture, the plots and the numbers of it; and
// what mouse, keys and buttons do.
import { shared_page, file_name, take_picture, unpack, Video } from "./capture";
import { Connection, token_of } from "./connection";
import { Controls } from "./controls";
import { by_id, note, plain_number, save_file } from "./dom";
import { listen_to_keys } from "./keys";
import { Legend } from "./legend";
import { decode } from "./messages";
import { Panel } from "./panel";
import { Playback } from "./playback";
import { Plots } from "./plots";
import { Pointer } from "./pointer";
import { Recording } from "./recording";
import { Session } from "./session";
import { Status } from "./status";
import { colour_of, on_theme_change } from "./theme";
import { Touch } from "./touch";
import { View } from "./view";

class Page {
  private readonly session_ = new Session();
  private readonly canvas_ = by_id<HTMLCanvasElement>("picture-canvas");
  private readonly recording_ = new Recording();
  private readonly video_ = new Video();
  private readonly view_ = View.open(this.canvas_, this.session_);
  private readonly plots_ = new Plots(this.session_, (t) => this.playback_?.seek(t));
  private readonly panel_ = new Panel(this.session_, () => this.view_?.frame_rate(performance.now()) ?? null);
  private readonly status_ = new Status(this.session_);
  private readonly legend_ = this.view_ && new Legend(this.view_, this.session_, (field) => this.connection_?.want(field));
  private readonly touch_ =
    this.view_ && new Touch(this.view_, (i) => this.radius(i), (...place) => this.connection_?.pointer(...place));
  private connection_: Connection | null = null;
  private playback_: Playback | null = null;
  private controls_ = new Controls(this.session_, {
    pause: () => this.pause(),
    step: (by) => this.step(by),
    home: () => this.home(),
    picture: () => this.picture(),
    video: () => this.film(),
    share: () => void this.share(),
    choose: (scene) => this.connection_?.choose(scene),
    tool: (tool) => this.choose_tool(tool),
    seconds: (seconds) => {
      this.plots_.seconds = seconds;
      this.plots_.invalidate();
    },
  });
  private last_frame_ = 0;
  private shown_ = -1; // the step of the surface that was drawn last

  start(): void {
    this.canvas_.hidden = by_id("legend").hidden = this.view_ === null;
    by_id("no-picture").hidden = this.view_ !== null;
    if (this.view_ && this.touch_) {
      new Pointer(this.canvas_, this.view_, this.touch_, { touchable: () => this.controls_.touchable() });
    }
    this.canvas_.addEventListener("webglcontextlost", () => note("The browser took the picture away; it usually comes back."));
    this.keys();
    on_theme_change(() => {
      this.view_?.theme();
      this.plots_.theme();
    });
    this.session_.listen((change, message) => {
      if (change === "scene") this.new_scene();
      if (message?.kind === "refused") note(`The server refused: ${message.why}`);
    });
    const embedded = document.getElementById("session");
    if (embedded) void this.open_recording(unpack(embedded.textContent ?? ""));
    else this.connect();
    requestAnimationFrame((now) => this.frame(now));
  }

  private new_scene(): void {
    this.legend_?.scene();
    this.touch_?.reset();
    if (this.controls_.tool >= (this.session_.scene?.tools.length ?? 0)) this.choose_tool(0);
  }

  private connect(): void {
    this.connection_ = new Connection(token_of(location.hash), {
      link: (now, seconds) => {
        this.status_.link(now, seconds);
        if (now === "open") this.legend_?.want();
      },
      message: (data) => this.receive(data),
    });
  }

  private receive(data: string | ArrayBuffer): void {
    const message = decode(data);
    this.session_.apply(message);
    if (!message) return;
    this.status_.heard();
    if (message.kind === "scene" && message.scene.recorded) {
      this.connection_?.close();
      void this.open_recording(fetch("session").then((answer) => answer.arrayBuffer()));
    } else if (message.kind !== "refused") {
      this.recording_.add(data, message, this.session_);
    }
  }

  private async open_recording(bytes: Promise<ArrayBuffer>): Promise<void> {
    try {
      const playback = new Playback(await bytes, this.session_);
      if (playback.empty) throw new Error("it is empty");
      if (playback.damaged) note("This recording is cut short; it plays as far as it goes.");
      this.playback_ = playback;
      this.status_.recorded();
      this.controls_.recorded(playback);
      playback.seek(playback.start);
      playback.play();
    } catch (error) {
      note(`The recording cannot be read: ${error instanceof Error ? error.message : error}`);
    }
  }

  private frame(now: number): void {
    requestAnimationFrame((next) => this.frame(next));
    this.playback_?.advance(Math.min(0.25, (now - this.last_frame_) / 1000));
    this.last_frame_ = now;
    this.touch_?.frame(now, 0.11 * (this.view_?.orbit.distance ?? 1));
    if (this.view_?.draw(now)) this.legend_?.draw();
    this.tell_shown();
    this.plots_.draw(now);
    this.panel_.draw(now);
    this.controls_.draw();
    this.status_.draw(now);
  }

  /** A page that draws nothing, for want of WebGL, has seen all it ever will as well. */
  private tell_shown(): void {
    const step = this.session_.shape?.known ? this.session_.shape.step : this.shown_;
    if (step === this.shown_) return;
    this.shown_ = step;
    this.connection_?.shown(step);
  }

  private keys(): void {
    const help = by_id<HTMLDialogElement>("keys");
    listen_to_keys(this.canvas_, {
      pause: () => this.pause(),
      step: (by) => this.step(by),
      next_look: (by) => this.legend_?.next_look(by),
      next_measure: () => this.legend_?.next_measure(),
      home: () => this.home(),
      zoom: (factor) => this.move(() => this.view_?.orbit.zoom(factor)),
      turn: (yaw, pitch) => this.move(() => this.view_?.orbit.turn(yaw, pitch)),
      nudge: (right, up, away) => this.nudge(right, up, away),
      grip: (held) => {
        if (!held || this.controls_.touchable().length > 0) this.touch_?.set_buttons(held ? 1 : 0);
      },
      choose_tool: (tool) => this.choose_tool(tool),
      picture: () => this.picture(),
      video: () => this.film(),
      share: () => void this.share(),
      help: () => (help.open ? help.close() : help.showModal()),
    });
  }

  private nudge(right: number, up: number, away: number): void {
    const touchable = this.controls_.touchable();
    if (!this.touch_ || touchable.length === 0) return note("No tool here that this page may move.");
    if (!touchable.includes(this.touch_.tool)) this.touch_.tool = touchable[0];
    this.touch_.nudge(right, up, away, performance.now());
  }

  private choose_tool(tool: number): void {
    if (tool >= (this.session_.scene?.tools.length ?? 0)) return;
    this.plots_.tool = this.panel_.tool = this.controls_.tool = tool;
    if (this.touch_ && !this.touch_.active) this.touch_.tool = tool;
    this.plots_.invalidate();
    this.panel_.invalidate();
  }

  private pause(): void {
    if (this.playback_) return this.playback_.playing ? void (this.playback_.playing = false) : this.playback_.play();
    if (!this.controls_.pausable()) return note("This page may watch only: control needs the address with its token.");
    this.connection_?.pause(!this.session_.state?.paused);
  }

  private step(by: 1 | -1): void {
    if (this.playback_) return this.playback_.step(by);
    if (by < 0 || !this.controls_.pausable()) return;
    if (this.session_.state?.paused) this.connection_?.step();
    else note("Steps are for a session that is paused: Space.");
  }

  private home(): void {
    this.move(() => this.view_?.orbit.home());
  }

  private move(how: () => void): void {
    how();
    this.view_?.invalidate();
  }

  private name(end: string): string {
    return file_name(this.session_.scene?.title ?? "", end);
  }

  private picture(): void {
    if (!this.view_) return note("There is no picture to save.");
    this.view_.draw(performance.now(), true); // the browser keeps what is drawn only until this task ends
    const { measure, top, measured } = this.view_;
    const shown = measure.name !== "plain" && measured;
    take_picture(this.canvas_, this.name("png"), {
      title: `${this.session_.scene?.title ?? "Palpate"}, ${this.session_.t.toFixed(2)} s`,
      measure: shown ? measure.label : "",
      top: `${plain_number(top)} ${measure.unit}`,
      colour: colour_of("--ink"),
    });
  }

  private film(): void {
    if (this.video_.running) this.video_.stop();
    else if (this.view_) this.video_.start(this.canvas_, (end) => this.name(end));
    this.controls_.filming(this.video_.running);
  }

  private async share(): Promise<void> {
    if (this.playback_) return note("This is a recording already: its file can be shared.");
    if (this.recording_.seconds === 0) return note("Nothing to share yet.");
    const { seconds } = this.recording_;
    try {
      save_file(this.name("html"), await shared_page(this.recording_.save()));
      note(`The last ${Math.round(seconds)} s, in one file that opens in any browser.`);
    } catch (error) {
      note(`The file could not be made: ${error instanceof Error ? error.message : error}`);
    }
  }

  private radius(tool: number): number {
    return this.session_.scene?.tools[tool]?.radius ?? 0.005;
  }
}

new Page().start();
