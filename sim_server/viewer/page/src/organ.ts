// The organ on the screen: smooth, coloured by a measure, with the shadow of the tools on it, its edges and regions.
import {
  BufferAttribute, BufferGeometry, DoubleSide, Float32BufferAttribute, FrontSide, Group, LineBasicMaterial, LineSegments,
  Mesh, ShaderMaterial, Sphere, Vector3, Vector4,
} from "three";
import { kRamp } from "./colours";
import { kFragment, kVertex } from "./organ_shader";
import type { Shape } from "./shape";

export const kLooks = ["surface", "edges", "regions", "glass"] as const;
export type Look = (typeof kLooks)[number];
export const kMaxShadows = 8;

/** What throws a shadow: a rod between two places with a round tip at the first. */
export interface Caster {
  tip: Vector3;
  radius: number;
  end: Vector3;
  shaft: number; // radius, m
}

export class Organ {
  readonly group = new Group();
  readonly values: { current: Float32Array } = { current: new Float32Array(0) };
  private shape_: Shape | null = null;
  private look_: Look = "surface";
  private readonly material_ = new ShaderMaterial({
    vertexShader: kVertex,
    fragmentShader: kFragment,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
    uniforms: {
      ramp: { value: kRamp.map((c) => new Vector3(...c)) },
      top: { value: 1 },
      light: { value: new Vector3(0, 0, 1) },
      fill: { value: new Vector3(0, 0, 1) },
      regions: { value: 0 },
      alpha: { value: 1 },
      casters: { value: 0 },
      tips: { value: Array.from({ length: kMaxShadows }, () => new Vector4()) },
      ends: { value: Array.from({ length: kMaxShadows }, () => new Vector4()) },
    },
  });
  private readonly lines_material_ = new LineBasicMaterial({ color: 0x000000, transparent: true, opacity: 0.32 });
  private mesh_ = new Mesh(new BufferGeometry(), this.material_);
  private lines_: LineSegments | null = null;

  constructor() {
    this.group.add(this.mesh_);
  }

  get mesh(): Mesh {
    return this.mesh_;
  }

  /** Another topology. */
  show(shape: Shape | null): void {
    this.shape_ = shape;
    this.mesh_.geometry.dispose();
    this.forget_lines();
    const geometry = new BufferGeometry();
    this.mesh_.geometry = geometry;
    this.mesh_.visible = shape !== null;
    if (!shape) return;
    this.values.current = new Float32Array(shape.n);
    geometry.setAttribute("position", new BufferAttribute(shape.p, 3));
    geometry.setAttribute("normal", new BufferAttribute(shape.normals, 3));
    geometry.setAttribute("value", new BufferAttribute(this.values.current, 1));
    geometry.setAttribute("flags", new Float32BufferAttribute(shape.topology.flags, 1));
    geometry.setIndex(new BufferAttribute(shape.topology.corners, 1));
    const { box_min, box_size } = shape.topology;
    const centre = new Vector3(...box_min).addScaledVector(new Vector3(...box_size), 0.5);
    geometry.boundingSphere = new Sphere(centre, 10 * Math.hypot(...box_size)); // it moves: never hide it
    this.set_look(this.look_);
  }

  /** The shape moved, or the measure's numbers changed. `top` is what the end of the ramp stands for. */
  update(top: number): void {
    if (!this.shape_) return;
    this.shape_.update_normals();
    const { attributes } = this.mesh_.geometry;
    for (const name of ["position", "normal", "value"]) attributes[name].needsUpdate = true;
    this.material_.uniforms.top.value = top;
  }

  set_look(look: Look): void {
    this.look_ = look;
    const glass = look === "glass";
    this.material_.uniforms.regions.value = look === "regions" ? 1 : 0;
    this.material_.uniforms.alpha.value = glass ? 0.3 : 1;
    this.material_.transparent = glass;
    this.material_.depthWrite = !glass;
    this.material_.side = glass ? DoubleSide : FrontSide;
    this.material_.needsUpdate = true;
    const edges = look === "edges" || glass;
    if (edges && !this.lines_ && this.shape_) this.make_lines(this.shape_);
    if (this.lines_) this.lines_.visible = edges;
    this.lines_material_.opacity = glass ? 0.16 : 0.38;
  }

  /** Where the light is, seen from the organ, and what stands in its way. */
  light(from: Vector3, fill: Vector3, casters: Caster[]): void {
    const { uniforms } = this.material_;
    uniforms.light.value.copy(from);
    uniforms.fill.value.copy(fill);
    uniforms.casters.value = Math.min(kMaxShadows, casters.length);
    casters.slice(0, kMaxShadows).forEach((c, i) => {
      uniforms.tips.value[i].set(c.tip.x, c.tip.y, c.tip.z, c.radius);
      uniforms.ends.value[i].set(c.end.x, c.end.y, c.end.z, c.shaft);
    });
  }

  private make_lines(shape: Shape): void {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", this.mesh_.geometry.getAttribute("position"));
    geometry.setIndex(new BufferAttribute(shape.edges(), 1));
    geometry.boundingSphere = this.mesh_.geometry.boundingSphere;
    this.lines_ = new LineSegments(geometry, this.lines_material_);
    this.group.add(this.lines_);
  }

  private forget_lines(): void {
    if (!this.lines_) return;
    this.group.remove(this.lines_);
    this.lines_.geometry.dispose();
    this.lines_ = null;
  }
}
