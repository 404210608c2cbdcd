// Mouse, pen and fingers over the picture: a drag on the organ or a tool touches, any other drag turns the camera.
import type { Touch } from "./touch";
import type { View } from "./view";
import { pixels_of, radii_of } from "./wheel";

export interface Rules {
  /** The tools that a drag may move; none: every drag turns the camera. */
  touchable(): number[];
}

type Mode = "none" | "turn" | "shift" | "touch";

const kTurn = 0.008; // rad a pixel

export class Pointer {
  private mode_: Mode = "none";
  private readonly down_ = new Map<number, { x: number; y: number }>();

  constructor(
    private readonly canvas_: HTMLCanvasElement,
    private readonly view_: View,
    private readonly touch_: Touch,
    private readonly rules_: Rules,
  ) {
    canvas_.addEventListener("pointerdown", (event) => this.press(event));
    canvas_.addEventListener("pointermove", (event) => this.move(event));
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"] as const) {
      canvas_.addEventListener(name, (event) => this.release(event));
    }
    canvas_.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas_.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  private press(event: PointerEvent): void {
    this.canvas_.focus({ preventScroll: true, focusVisible: false } as FocusOptions); // a frame is for the keyboard
    this.canvas_.setPointerCapture(event.pointerId);
    const { offsetX: x, offsetY: y } = event;
    this.down_.set(event.pointerId, { x, y });
    if (this.down_.size > 1) {
      if (this.mode_ !== "touch") this.mode_ = "shift";
    } else if (event.button === 0 && !event.shiftKey && this.touch_.begin(x, y, this.rules_.touchable())) {
      this.mode_ = "touch";
    } else {
      this.mode_ = event.button === 0 && !event.shiftKey ? "turn" : "shift";
    }
    this.canvas_.dataset.mode = this.mode_;
    event.preventDefault();
  }

  private move(event: PointerEvent): void {
    const last = this.down_.get(event.pointerId);
    if (!last) return;
    const x = event.offsetX;
    const y = event.offsetY;
    const first = this.down_.keys().next().value === event.pointerId;
    if (this.mode_ === "touch" && first) this.touch_.drag(x, y);
    else if (this.mode_ === "touch") this.touch_.push(-(y - last.y) * this.view_.orbit.metres_per_pixel(this.view_.height));
    else if (this.down_.size === 2) this.pinch(event.pointerId, last, { x, y });
    else if (this.mode_ === "turn") this.view_.orbit.turn(-kTurn * (x - last.x), kTurn * (y - last.y));
    else this.view_.orbit.shift(x - last.x, y - last.y, this.view_.height);
    last.x = x;
    last.y = y;
    this.view_.invalidate();
  }

  /** Two fingers: their middle moves the target, the space between them zooms. */
  private pinch(id: number, last: { x: number; y: number }, now: { x: number; y: number }): void {
    const other = [...this.down_].find(([number]) => number !== id)![1];
    const before = Math.hypot(last.x - other.x, last.y - other.y);
    const after = Math.hypot(now.x - other.x, now.y - other.y);
    if (before > 1 && after > 1) this.view_.orbit.zoom(before / after);
    this.view_.orbit.shift((now.x - last.x) / 2, (now.y - last.y) / 2, this.view_.height);
  }

  private release(event: PointerEvent): void {
    if (!this.down_.delete(event.pointerId)) return;
    if (this.down_.size > 0) return;
    if (this.mode_ === "touch") this.touch_.end();
    this.mode_ = "none";
    delete this.canvas_.dataset.mode;
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    if (this.mode_ === "touch") this.touch_.push_by_radius(radii_of(event));
    else this.view_.orbit.zoom(Math.exp(pixels_of(event) * 0.0012));
    this.view_.invalidate();
  }
}
