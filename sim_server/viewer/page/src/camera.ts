// A camera that turns about a point: a drag orbits, the right button or two fingers move it, the wheel zooms. Turning is
// by angles about the world's z, so that up stays up.
import { PerspectiveCamera, Vector3 } from "three";

const kHome = { yaw: -0.95, pitch: 0.5 };
const kBeside = 0.35; // rad: from beside the tool, so that its shaft hides nothing

export class Orbit {
  readonly camera = new PerspectiveCamera(36, 1, 0.002, 20);
  readonly target = new Vector3();
  yaw = kHome.yaw; // rad, about z
  pitch = kHome.pitch; // rad, above the horizon
  distance = 0.5; // m
  private home_ = { target: new Vector3(), radius: 0.1, ...kHome };

  /** Half the diagonal of what the home view shows, m. */
  get radius(): number {
    return this.home_.radius;
  }

  /** What the home view shows: all these places (3n, m), from the side that `facing`, if any, points to. */
  frame(places: Float32Array, facing: Vector3 | null): void {
    const [x, y, z] = [0, 1, 2].map((i) => extent(places, (p, at) => p[at + i]));
    this.home_.target.set(x.middle, y.middle, z.middle);
    this.home_.radius = Math.max(1e-3, Math.hypot(x.size, y.size, z.size) / 2);
    Object.assign(this.home_, kHome);
    if (facing) this.face(facing, places);
    this.home();
  }

  private face({ x, y, z }: Vector3, places: Float32Array): void {
    const flat = Math.hypot(x, y);
    if (flat < 0.5 * Math.abs(z)) {
      this.home_.pitch = z > 0 ? kHome.pitch : -kHome.pitch; // from above or below: from any side
      return;
    }
    // Of the two views from beside the tool, the one that shows more of the organ.
    const yaws = [-kBeside, kBeside].map((beside) => Math.atan2(y, x) + beside);
    const widths = yaws.map((a) => extent(places, (p, at) => p[at + 1] * Math.cos(a) - p[at] * Math.sin(a)).size);
    this.home_.yaw = widths[1] > widths[0] ? yaws[1] : yaws[0];
    this.home_.pitch = Math.atan2(z, flat) / 2 + 0.35;
  }

  home(): void {
    this.target.copy(this.home_.target);
    this.yaw = this.home_.yaw;
    this.pitch = this.home_.pitch;
    this.fit();
    this.place();
  }

  /** After the picture's size changed. */
  resize(width: number, height: number): void {
    this.camera.aspect = width / Math.max(1, height);
    this.camera.updateProjectionMatrix();
  }

  turn(yaw: number, pitch: number): void {
    this.yaw += yaw;
    this.pitch = Math.min(1.5, Math.max(-1.5, this.pitch + pitch));
    this.place();
  }

  /** By pixels of a picture of some height. */
  shift(dx: number, dy: number, height: number): void {
    const { right, up } = this.axes();
    const metres = this.metres_per_pixel(height);
    this.target.addScaledVector(right, -dx * metres).addScaledVector(up, dy * metres);
    this.place();
  }

  zoom(factor: number): void {
    const { radius } = this.home_;
    this.distance = Math.min(20 * radius, Math.max(0.2 * radius, this.distance * factor));
    this.place();
  }

  /** At the target. */
  metres_per_pixel(height: number): number {
    return (2 * this.distance * Math.tan((this.camera.fov * Math.PI) / 360)) / Math.max(1, height);
  }

  axes(): { right: Vector3; up: Vector3; back: Vector3 } {
    const e = this.camera.matrixWorld.elements;
    return {
      right: new Vector3(e[0], e[1], e[2]),
      up: new Vector3(e[4], e[5], e[6]),
      back: new Vector3(e[8], e[9], e[10]),
    };
  }

  private fit(): void {
    const half = (this.camera.fov * Math.PI) / 360;
    const narrow = Math.atan(Math.tan(half) * Math.min(1, this.camera.aspect));
    this.distance = (0.86 * this.home_.radius) / Math.sin(narrow);
  }

  private place(): void {
    const flat = Math.cos(this.pitch) * this.distance;
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(
      this.target.x + Math.cos(this.yaw) * flat,
      this.target.y + Math.sin(this.yaw) * flat,
      this.target.z + Math.sin(this.pitch) * this.distance,
    );
    this.camera.lookAt(this.target);
    this.camera.near = Math.max(1e-3, this.distance / 100);
    this.camera.far = this.distance + 30 * this.home_.radius;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }
}

/** From the smallest to the largest of a number at places (3n). */
function extent(places: Float32Array, number: (p: Float32Array, at: number) => number): { size: number; middle: number } {
  let least = Infinity;
  let most = -Infinity;
  for (let at = 0; at < places.length; at += 3) {
    const value = number(places, at);
    if (value < least) least = value;
    if (value > most) most = value;
  }
  return { size: most - least, middle: (most + least) / 2 };
}
