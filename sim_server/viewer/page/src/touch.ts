// A tool moved from the page: where the mouse wants it, in a plane that faces the camera. No events and no drawing here.
import { Vector3 } from "three";
import type { View } from "./view";

export type Send = (tool: number, p: [number, number, number], buttons: number) => void;

const kGrab = 26; // pixels: this near to a tip, a press takes the tool where it is
const kFar = 0.025; // m: beyond, a tool does not plough through the organ to get there, but is lifted over it
const kLift = 0.35; // of the way
const kQuickest = 0.3; // m/s, while it goes there
const kSendEach = 15; // ms at least: a display may be faster than the server listens
const kLinger = 900; // ms that the plane stays after a key

export class Touch {
  tool = 0;
  active = false;
  buttons = 0;
  readonly wanted = new Vector3();
  private readonly offset_ = new Vector3(); // of the wanted place from where the ray meets the plane
  private route_: Vector3[] = []; // on the way to the wanted place
  private readonly sent_ = new Vector3();
  private framed_ = 0; // ms
  private sent_at_ = 0; // ms
  private shown_until_ = 0;
  private unsent_ = false;

  constructor(private readonly view_: View, private readonly radius_of_: (tool: number) => number, private readonly send_: Send) {}

  /** A press: takes a tool whose tip is near the pixel, or else touches the organ there. False: neither is there. */
  begin(x: number, y: number, touchable: number[]): boolean {
    const near = touchable
      .filter((i) => this.view_.tools[i])
      .map((tool) => ({ tool, at: this.view_.project(this.view_.tools[tool].tip) }))
      .map(({ tool, at }) => ({ tool, away: Math.hypot(at.x - x, at.y - y) }))
      .sort((a, b) => a.away - b.away)[0];
    if (!near) return false;
    const hit = this.view_.pick(x, y);
    if (near.away > kGrab && !hit) return false;
    this.tool = near.tool;
    this.wanted.copy(this.view_.tools[near.tool].tip);
    this.sent_.copy(this.wanted);
    this.route_ = [];
    if (near.away > kGrab) {
      this.wanted.copy(hit!.place).addScaledVector(hit!.normal, this.radius_of_(near.tool));
      this.find_route();
    }
    this.offset_.copy(this.wanted).sub(this.on_plane(x, y));
    this.active = this.unsent_ = true;
    return true;
  }

  drag(x: number, y: number): void {
    this.wanted.copy(this.on_plane(x, y)).add(this.offset_);
    this.unsent_ = true;
  }

  /** Away from the camera, m. */
  push(metres: number): void {
    this.wanted.addScaledVector(this.view_.orbit.axes().back, -metres);
    this.unsent_ = true;
  }

  /** Away from the camera, as a share of the tip's radius. */
  push_by_radius(share: number): void {
    this.push(share * this.radius_of_(this.tool));
  }

  end(): void {
    this.active = false;
    this.unsent_ = true;
  }

  /** Another scene, or another connection to it: nothing is held any more, and no button is down. */
  reset(): void {
    this.active = this.unsent_ = false;
    this.buttons = 0;
    this.route_ = [];
    this.shown_until_ = 0;
  }

  /** By keys: right, up and away from the camera, as shares of the tip's radius. */
  nudge(right: number, up: number, away: number, now: number): void {
    if (!this.view_.tools[this.tool]) return;
    if (!this.active && now > this.shown_until_) this.take_up();
    const axes = this.view_.orbit.axes();
    const radius = this.radius_of_(this.tool);
    this.wanted
      .addScaledVector(axes.right, right * radius)
      .addScaledVector(axes.up, up * radius)
      .addScaledVector(axes.back, -away * radius);
    this.shown_until_ = now + kLinger;
    this.unsent_ = true;
  }

  private take_up(): void {
    this.wanted.copy(this.view_.tools[this.tool].tip);
    this.route_ = [];
  }

  set_buttons(buttons: number): void {
    if (buttons === this.buttons) return;
    this.buttons = buttons;
    if (!this.active && this.view_.tools[this.tool] && !this.unsent_) this.take_up();
    this.unsent_ = true;
    if (buttons === 0) this.send(); // a page that is not seen draws no frame
  }

  private send(): void {
    this.follow_route(0);
    this.send_(this.tool, [this.sent_.x, this.sent_.y, this.sent_.z], this.buttons);
    this.unsent_ = this.route_.length > 0; // it also gets there if the button is up by then
  }

  /** Once a frame: sends what is new, and while the button is down always, if it is time; draws the plane. */
  frame(now: number, half: number): void {
    const { touch_plane, orbit, tools } = this.view_;
    if (this.active || this.unsent_) {
      this.follow_route((now - this.framed_) / 1000);
      if (now - this.sent_at_ >= kSendEach) {
        this.sent_at_ = now;
        this.send();
      }
    }
    this.framed_ = now;
    const shown = this.active || now < this.shown_until_;
    if (shown !== touch_plane.group.visible || shown) this.view_.invalidate();
    if (shown && tools[this.tool]) {
      touch_plane.show(this.wanted, tools[this.tool].tip, orbit.camera.quaternion, half, this.radius_of_(this.tool));
    } else {
      touch_plane.hide();
    }
  }

  /** To a place far away: towards the camera, across, and down. */
  private find_route(): void {
    const { back } = this.view_.orbit.axes();
    const way = this.wanted.distanceTo(this.sent_);
    if (way < kFar) return;
    const height = Math.max(this.sent_.dot(back), this.wanted.dot(back)) + kLift * way;
    const lifted = (place: Vector3) => place.clone().addScaledVector(back, height - place.dot(back));
    this.route_ = [lifted(this.sent_), lifted(this.wanted), this.wanted];
  }

  private follow_route(seconds: number): void {
    let left = kQuickest * Math.min(0.1, seconds);
    while (this.route_.length > 0) {
      const next = this.route_[0];
      const way = this.sent_.distanceTo(next);
      if (way > left) {
        this.sent_.lerp(next, left / way);
        return;
      }
      left -= way;
      this.sent_.copy(next);
      this.route_.shift();
    }
    this.sent_.copy(this.wanted);
  }

  /** Where a pixel's ray meets the plane through the wanted place that faces the camera. */
  private on_plane(x: number, y: number): Vector3 {
    const { from, along } = this.view_.ray(x, y);
    const { back } = this.view_.orbit.axes();
    const distance = this.wanted.clone().sub(from).dot(back) / along.dot(back);
    return from.addScaledVector(along, distance);
  }
}
