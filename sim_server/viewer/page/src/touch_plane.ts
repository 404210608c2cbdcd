// The plane in which the mouse moves a tool, drawn as a grid that cuts the organ; and the place that the mouse wants, with
// a line to where the tool is: its length is the lag, or the force that holds the tool back.
import { BufferAttribute, BufferGeometry, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial,
  PlaneGeometry, type Quaternion, RingGeometry, Vector3 } from "three";

const kCells = 8;

export class TouchPlane {
  readonly group = new Group();
  private readonly plane_ = new Group();
  private readonly lines_ = new LineBasicMaterial({ transparent: true, opacity: 0.35, depthWrite: false });
  private readonly sheet_ = new MeshBasicMaterial({ transparent: true, opacity: 0.05, depthWrite: false, side: DoubleSide });
  private readonly mark_ = new MeshBasicMaterial({ depthTest: false, transparent: true, side: DoubleSide });
  private readonly band_ = new LineBasicMaterial({ depthTest: false, transparent: true, opacity: 0.9 });
  private readonly ring_ = new Mesh(new RingGeometry(0.91, 1, 64), this.mark_);
  private readonly ends_ = new BufferAttribute(new Float32Array(6), 3);

  constructor() {
    const sheet = new Mesh(new PlaneGeometry(2, 2), this.sheet_);
    const grid = new LineSegments(new BufferGeometry().setAttribute("position", grid_lines()), this.lines_);
    this.plane_.add(sheet, grid);
    const band = new LineSegments(new BufferGeometry().setAttribute("position", this.ends_), this.band_);
    band.frustumCulled = false;
    sheet.renderOrder = grid.renderOrder = 1;
    this.ring_.renderOrder = band.renderOrder = 3;
    this.group.add(this.plane_, this.ring_, band);
    this.group.visible = false;
  }

  colour(colour: string): void {
    for (const material of [this.lines_, this.sheet_, this.mark_, this.band_]) material.color.set(colour);
  }

  hide(): void {
    this.group.visible = false;
  }

  /** The wanted place, where the tool is, how the camera is turned, half the side of the plane, the tool's radius: m. */
  show(wanted: Vector3, tool: Vector3, turn: Quaternion, half: number, radius: number): void {
    this.group.visible = true;
    this.plane_.position.copy(wanted);
    this.plane_.quaternion.copy(turn);
    this.plane_.scale.setScalar(half);
    this.ring_.position.copy(wanted);
    this.ring_.quaternion.copy(turn);
    this.ring_.scale.setScalar(1.5 * radius);
    this.ends_.setXYZ(0, wanted.x, wanted.y, wanted.z);
    this.ends_.setXYZ(1, tool.x, tool.y, tool.z);
    this.ends_.needsUpdate = true;
  }
}

function grid_lines(): BufferAttribute {
  const places: number[] = [];
  for (let i = 0; i <= kCells; i++) {
    const at = (2 * i) / kCells - 1;
    places.push(at, -1, 0, at, 1, 0, -1, at, 0, 1, at, 0);
  }
  return new BufferAttribute(new Float32Array(places), 3);
}
