// The picture: renderer, lights, camera, and what is drawn of a session. Draws only when something changed.
import { Color, DirectionalLight, HemisphereLight, Raycaster, Scene, Vector2, Vector3, WebGLRenderer } from "three";
import { Orbit } from "./camera";
import { kMeasures, type Measure, measure, nice_above, Scale } from "./colours";
import { type Look, Organ } from "./organ";
import type { Shape } from "./shape";
import type { Session } from "./session";
import { colour_of } from "./theme";
import { Loads, ToolDrawing } from "./tools";
import { TouchPlane } from "./touch_plane";

export class View {
  readonly orbit = new Orbit();
  readonly touch_plane = new TouchPlane();
  measure: Measure = kMeasures[0];
  look: Look = "surface";
  top = 1; // what the end of the ramp stands for, in the measure's unit
  measured = true;
  newtons = 1; // what an arrow of arrow_metres stands for
  arrow_metres = 0.04;
  private readonly renderer_: WebGLRenderer;
  private readonly scene_ = new Scene();
  private readonly organ_ = new Organ();
  private readonly loads_ = new Loads();
  private readonly lamp_ = new DirectionalLight(0xffffff, 2.6);
  private tools_: ToolDrawing[] = [];
  private readonly scale_ = new Scale();
  private largest_force_ = 0;
  private readonly drawn_: number[] = []; // ms, of the pictures of the last second
  private stale_ = true;
  private moved_ = true;
  private framed_: "nothing" | "tool" | "organ" = "nothing"; // what of this scene the camera has found

  /** Throws nothing, but gives null where the browser has no WebGL. */
  static open(canvas: HTMLCanvasElement, session: Session): View | null {
    const context = canvas.getContext("webgl2", { antialias: true, alpha: false, powerPreference: "high-performance" });
    return context ? new View(canvas, context, session) : null;
  }

  private constructor(
    private readonly canvas_: HTMLCanvasElement,
    context: WebGL2RenderingContext,
    private readonly session_: Session,
  ) {
    this.renderer_ = new WebGLRenderer({ canvas: canvas_, context });
    const sky = new HemisphereLight(0xffffff, 0x4a5560, 1.5);
    this.scene_.add(sky, this.lamp_, this.lamp_.target, this.organ_.group, this.loads_.group, this.touch_plane.group);
    this.theme();
    this.set_look(this.look);
    new ResizeObserver(() => this.resize()).observe(canvas_.parentElement!);
    this.resize();
    session_.listen((change) => {
      if (change === "scene") {
        this.framed_ = "nothing";
        this.make_tools();
      }
      if (change === "scene" || change === "topology") this.show_shape();
      if (change === "cut") this.organ_.show(session_.shape);
      if (change === "state" && this.framed_ === "nothing") this.frame(session_.shape);
      if (change === "cut" || change === "surface" || change === "field" || change === "state") this.moved_ = true;
      if (change === "reset") this.largest_force_ = 0;
      this.stale_ = true;
    });
    this.make_tools();
    this.show_shape();
  }

  get tools(): readonly ToolDrawing[] {
    return this.tools_;
  }

  get height(): number {
    return this.canvas_.clientHeight;
  }

  invalidate(): void {
    this.stale_ = true;
  }

  theme(): void {
    this.scene_.background = new Color(colour_of("--scene"));
    this.tools_.forEach((tool) => tool.colour_arrow(colour_of("--force")));
    this.loads_.colour(colour_of("--load"), this.renderer_.getPixelRatio());
    this.touch_plane.colour(colour_of("--touch"));
    this.stale_ = true;
  }

  set_measure(measured: Measure): void {
    this.measure = measured;
    this.scale_.restart();
    this.moved_ = this.stale_ = true;
  }

  set_look(look: Look): void {
    this.look = look;
    this.organ_.set_look(look);
    this.stale_ = true;
  }

  /** Draws if something changed since; says whether. */
  draw(now: number, force = false): boolean {
    if (!this.stale_ && !force) return false;
    this.stale_ = false;
    if (this.moved_) this.update(now);
    this.moved_ = false;
    const { right, up, back } = this.orbit.axes();
    const light = right.clone().multiplyScalar(0.4).addScaledVector(up, 0.66).addScaledVector(back, 0.68).normalize();
    const fill = right.multiplyScalar(-0.8).addScaledVector(back, 0.6).normalize();
    const state = this.session_.state;
    const drawn = this.tools_.filter((_, i) => state?.tools[i]?.held);
    this.organ_.light(light, fill, drawn.map((tool) => tool.caster()));
    this.lamp_.position.copy(this.orbit.target).add(light);
    this.lamp_.target.position.copy(this.orbit.target);
    this.renderer_.render(this.scene_, this.orbit.camera);
    this.drawn_.push(now);
    return true;
  }

  /** Pictures in the last second. */
  frame_rate(now: number): number {
    while (this.drawn_.length && this.drawn_[0] < now - 1000) this.drawn_.shift();
    return this.drawn_.length;
  }

  /** Where a pixel's ray meets the organ, and the surface's normal there. */
  pick(x: number, y: number): { place: Vector3; normal: Vector3 } | null {
    const ray = new Raycaster();
    ray.setFromCamera(this.to_device(x, y), this.orbit.camera);
    const hit = ray.intersectObject(this.organ_.mesh, false)[0];
    return hit ? { place: hit.point, normal: hit.face!.normal } : null;
  }

  /** The ray of a pixel of the canvas. */
  ray(x: number, y: number): { from: Vector3; along: Vector3 } {
    const ray = new Raycaster();
    ray.setFromCamera(this.to_device(x, y), this.orbit.camera);
    return { from: ray.ray.origin, along: ray.ray.direction };
  }

  /** Pixels of the canvas. */
  project(place: Vector3): { x: number; y: number } {
    const p = place.clone().project(this.orbit.camera);
    return { x: ((p.x + 1) / 2) * this.canvas_.clientWidth, y: ((1 - p.y) / 2) * this.canvas_.clientHeight };
  }

  private to_device(x: number, y: number): Vector2 {
    return new Vector2((2 * x) / this.canvas_.clientWidth - 1, 1 - (2 * y) / this.canvas_.clientHeight);
  }

  private update(now: number): void {
    const { shape, state } = this.session_;
    const values = this.organ_.values.current;
    if (shape) {
      this.measured = measure(this.session_, this.measure.name, values);
      let largest = 0;
      for (let i = 0; i < values.length; i++) if (values[i] > largest) largest = values[i];
      this.top = this.scale_.follow(largest, this.measure, now);
      this.organ_.update(this.top / this.measure.scale);
    }
    if (!state) return;
    for (const tool of state.tools) this.largest_force_ = Math.max(this.largest_force_, Math.hypot(...tool.f));
    this.newtons = nice_above(Math.max(0.05, 0.6 * this.largest_force_));
    const metres_per_newton = this.arrow_metres / this.newtons;
    this.tools_.forEach((tool, i) => {
      const at = state.tools[i];
      tool.group.visible = at !== undefined;
      if (at) tool.update(at, metres_per_newton, this.outward(at.p));
    });
    if (shape) this.loads_.update(shape, state.tools, metres_per_newton);
  }

  private make_tools(): void {
    for (const tool of this.tools_) {
      this.scene_.remove(tool.group);
      tool.dispose();
    }
    this.tools_ = (this.session_.scene?.tools ?? []).map((shape) => new ToolDrawing(shape));
    for (const tool of this.tools_) {
      tool.group.visible = false;
      tool.colour_arrow(colour_of("--force"));
      this.scene_.add(tool.group);
    }
  }

  private show_shape(): void {
    const { shape } = this.session_;
    this.organ_.show(shape);
    this.scale_.restart();
    this.moved_ = true;
    if (shape && this.framed_ !== "organ") this.frame(shape);
  }

  /** The surface's normal where it is nearest to a place. */
  private outward(place: ArrayLike<number>): Vector3 {
    const { shape } = this.session_;
    return shape ? new Vector3().fromArray(shape.normals, 3 * shape.nearest(place)) : new Vector3(0, 0, 1);
  }

  /** The first view of a scene; again when the first state says where the tool is. */
  private frame(shape: Shape | null): void {
    const tool = this.session_.state?.tools.find((t) => t.held) ?? null;
    if (this.session_.state) this.framed_ = shape ? "organ" : tool ? "tool" : "nothing";
    const around = shape ? shape.topology.rest : room_around(tool?.p ?? [0, 0, 0]);
    this.orbit.frame(around, tool && this.outward(tool.p));
    this.arrow_metres = 0.24 * this.orbit.radius;
  }

  private resize(): void {
    const host = this.canvas_.parentElement!;
    this.renderer_.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer_.setSize(host.clientWidth, host.clientHeight);
    this.orbit.resize(host.clientWidth, host.clientHeight);
    this.draw(performance.now(), true); // at once: an emptied canvas would flicker
  }
}

/** The corners of 10 cm about a place. */
function room_around(place: ArrayLike<number>): Float32Array {
  const half = 0.05;
  return Float32Array.from([-half, half].flatMap((by) => [0, 1, 2].map((i) => place[i] + by)));
}
