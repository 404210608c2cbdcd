// The tools on the screen: tip, shaft, trocar, the force on them, what they press on, and where the mouse wants them.
import {
  BufferAttribute, BufferGeometry, CapsuleGeometry, ConeGeometry, CylinderGeometry, DynamicDrawUsage, Group, LineSegments,
  LineBasicMaterial, Mesh, MeshBasicMaterial, MeshStandardMaterial, type Object3D, Points, PointsMaterial, Quaternion,
  SphereGeometry, TorusGeometry, Vector3,
} from "three";
import type { Caster } from "./organ";
import type { Shape } from "./shape";
import type { ToolNow, ToolShape } from "./text_messages";

const kZ = new Vector3(0, 0, 1);
const kY = new Vector3(0, 1, 0);
const kShaft = 0.45; // of the tip's radius
const kOutside = 0.06; // m of an instrument beyond its trocar
const kFollows = 0.04; // of the way, each step
const kStem = 0.09; // m of the stem that holds a ball: it touches nothing

export class ToolDrawing {
  readonly group = new Group();
  readonly tip = new Vector3();
  private readonly steel_ = new MeshStandardMaterial({ color: 0xc9d3da, metalness: 0.35, roughness: 0.35 });
  private readonly shaft_steel_ = new MeshStandardMaterial({ color: 0x8c99a3, metalness: 0.4, roughness: 0.45 });
  private readonly tip_: Mesh;
  private readonly shaft_: Mesh;
  private readonly ring_: Mesh | null;
  private readonly arrow_ = new Arrow();
  private end_ = new Vector3();
  private readonly shaft_radius_: number;
  private readonly stem_ = new Vector3();

  constructor(private readonly shape_: ToolShape) {
    const { radius, length, trocar } = shape_;
    this.shaft_radius_ = shape_.shaft_radius ?? kShaft * radius;
    const ball = shape_.shape === "sphere" || length <= 0;
    this.tip_ = new Mesh(ball ? new SphereGeometry(radius, 32, 20) : new CapsuleGeometry(radius, length, 12, 28), this.steel_);
    this.shaft_ = new Mesh(new CylinderGeometry(1, 1, 1, 20), this.shaft_steel_);
    this.ring_ = trocar ? new Mesh(new TorusGeometry(2.2 * radius, 0.45 * radius, 12, 36), this.shaft_steel_) : null;
    this.group.add(this.tip_, this.shaft_, this.arrow_.group);
    if (this.ring_) this.group.add(this.ring_);
  }

  /** Where it is, and the force on it, drawn as so many metres a newton. `outward`: from the organ, where it is near. */
  update(now: ToolNow, metres_per_newton: number, outward: Vector3): void {
    const { radius, length, trocar } = this.shape_;
    const turn = new Quaternion(now.q[1], now.q[2], now.q[3], now.q[0]).normalize();
    this.tip.set(...now.p);
    const axis = new Vector3(...(this.shape_.axis ?? [0, 0, 1])).applyQuaternion(turn).normalize();
    this.tip_.position.copy(this.tip);
    this.end_.copy(this.tip);
    if (trocar) {
      const inside = new Vector3(...trocar).sub(this.tip);
      axis.copy(inside).normalize();
      this.end_.addScaledVector(axis, inside.length() + kOutside);
      this.ring_!.position.set(...trocar);
      this.ring_!.quaternion.setFromUnitVectors(kZ, axis);
    } else if (length > 0) {
      this.tip_.quaternion.setFromUnitVectors(kY, axis);
      this.tip_.position.addScaledVector(axis, length / 2);
      this.end_.addScaledVector(axis, length);
    } else if (this.shape_.axis) {
      // A ball that nobody turned has no direction: its stem comes from outside, and follows as a hand would.
      this.stem_.lerp(outward, this.stem_.lengthSq() > 0 ? kFollows : 1).normalize();
      if (Math.abs(now.q[0]) > 1 - 1e-9) axis.copy(this.stem_);
      this.end_.addScaledVector(axis, kStem);
    }
    this.shaft_.visible = this.end_.distanceTo(this.tip) > radius && (trocar !== null || length <= 0);
    between(this.shaft_, this.tip, this.end_, this.shaft_radius_);
    for (const material of [this.steel_, this.shaft_steel_]) {
      material.transparent = !now.held;
      material.opacity = now.held ? 1 : 0.35;
    }
    this.steel_.emissive.setHex(now.flagged ? 0x7a3b00 : 0);
    this.arrow_.update(this.tip, new Vector3(...now.f), metres_per_newton, radius);
  }

  colour_arrow(colour: string): void {
    this.arrow_.material.color.set(colour);
  }

  /** What throws the shadow. */
  caster(): Caster {
    const { radius, length } = this.shape_;
    const thick = length > 0 && !this.shape_.trocar ? radius : this.shaft_radius_;
    return { tip: this.tip, radius, end: this.end_, shaft: this.end_.equals(this.tip) ? 0 : thick };
  }

  dispose(): void {
    this.group.traverse((o: Object3D) => o instanceof Mesh && o.geometry.dispose());
    this.steel_.dispose();
    this.shaft_steel_.dispose();
  }
}

/** A rod of unit length along y, put between two places. */
function between(rod: Mesh, a: Vector3, b: Vector3, radius: number): void {
  const along = b.clone().sub(a);
  rod.position.copy(a).addScaledVector(along, 0.5);
  rod.scale.set(radius, Math.max(1e-6, along.length()), radius);
  rod.quaternion.setFromUnitVectors(kY, along.normalize());
}

class Arrow {
  readonly group = new Group();
  readonly material = new MeshBasicMaterial({ depthTest: false, transparent: true }); // over the shaft
  private readonly rod_ = new Mesh(new CylinderGeometry(1, 1, 1, 16), this.material);
  private readonly head_ = new Mesh(new ConeGeometry(1, 1, 24), this.material);

  constructor() {
    this.rod_.renderOrder = this.head_.renderOrder = 2;
    this.group.add(this.rod_, this.head_);
  }

  update(from: Vector3, force: Vector3, metres_per_newton: number, radius: number): void {
    const length = force.length() * metres_per_newton;
    this.group.visible = length > 0.3 * radius;
    if (!this.group.visible) return;
    const direction = force.clone().normalize();
    const head = Math.min(0.5 * length, 1.5 * radius);
    const neck = from.clone().addScaledVector(direction, radius + length - head);
    between(this.rod_, from.clone().addScaledVector(direction, 0.8 * radius), neck, 0.2 * radius);
    this.head_.position.copy(neck).addScaledVector(direction, head / 2);
    this.head_.scale.set(0.55 * radius, head, 0.55 * radius);
    this.head_.quaternion.copy(this.rod_.quaternion);
  }
}

/** Where the tools press on the organ, and how hard: a dot and a line at each vertex with a load. */
export class Loads {
  readonly group = new Group();
  private readonly places_ = attribute(256);
  private readonly lines_ = attribute(512);
  private readonly points_: Points;
  private readonly segments_: LineSegments;
  private readonly dots_ = new PointsMaterial({ size: 5, sizeAttenuation: false, depthTest: false, transparent: true });
  private readonly strokes_ = new LineBasicMaterial({ depthTest: false, transparent: true, opacity: 0.8 });

  constructor() {
    this.points_ = new Points(new BufferGeometry().setAttribute("position", this.places_), this.dots_);
    this.segments_ = new LineSegments(new BufferGeometry().setAttribute("position", this.lines_), this.strokes_);
    for (const object of [this.segments_, this.points_]) {
      object.frustumCulled = false;
      object.renderOrder = 2;
      this.group.add(object);
    }
  }

  colour(colour: string, pixel_ratio: number): void {
    this.dots_.color.set(colour);
    this.dots_.size = 2.5 * pixel_ratio;
    this.strokes_.color.set(colour);
  }

  update(shape: Shape, tools: ToolNow[], metres_per_newton: number): void {
    const all = tools.flatMap((tool) => tool.loads).filter(([v]) => v < shape.n).slice(0, 256);
    all.forEach(([v, x, y, z], i) => {
      const at = shape.p.subarray(3 * v, 3 * v + 3);
      this.places_.setXYZ(i, at[0], at[1], at[2]);
      this.lines_.setXYZ(2 * i, at[0], at[1], at[2]);
      const s = metres_per_newton;
      this.lines_.setXYZ(2 * i + 1, at[0] + s * x, at[1] + s * y, at[2] + s * z);
    });
    this.points_.geometry.setDrawRange(0, all.length);
    this.segments_.geometry.setDrawRange(0, 2 * all.length);
    this.places_.needsUpdate = this.lines_.needsUpdate = true;
  }
}

function attribute(n: number): BufferAttribute {
  return new BufferAttribute(new Float32Array(3 * n), 3).setUsage(DynamicDrawUsage);
}
