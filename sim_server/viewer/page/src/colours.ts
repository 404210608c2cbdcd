// What the organ is coloured by: the numbers, the ramp from low to high, and the legend with its units.
import type { Session } from "./session";

export interface Measure {
  name: string;
  label: string;
  unit: string;
  scale: number; // from SI to the unit
  least: number; // in the unit: the top of the legend is never below this
}

export const kMeasures: Measure[] = [
  { name: "displacement", label: "Displacement", unit: "mm", scale: 1e3, least: 0.5 },
  { name: "stretch", label: "Surface stretch", unit: "%", scale: 100, least: 2 },
  { name: "pressure", label: "Contact pressure", unit: "kPa", scale: 1e-3, least: 0.1 },
  { name: "strain_energy", label: "Strain energy", unit: "J/m\u00b3", scale: 1, least: 0.1 },
  { name: "plain", label: "No colour", unit: "", scale: 1, least: 1 },
];

// From the tissue at rest to the largest: lightness rises all the way, so that it also reads without colour.
export const kRamp: [number, number, number][] = [
  [0.45, 0.225, 0.235],
  [0.64, 0.275, 0.285],
  [0.83, 0.38, 0.255],
  [0.945, 0.58, 0.26],
  [0.98, 0.785, 0.4],
  [1.0, 0.955, 0.72],
];

/** A blade moves vertices within the body at rest, of which the page is told no more. */
export function rest_moved(session: Session): boolean {
  return session.scene?.blades === true && (session.shape?.topology.version ?? 0) > 1;
}

/** The measure's numbers at the vertices, SI; false where there are none to show. */
export function measure(session: Session, name: string, out: Float32Array): boolean {
  const { shape, field } = session;
  if (!shape) return false;
  if ((name === "displacement" || name === "stretch") && rest_moved(session)) {
    out.fill(0);
    return false;
  }
  if (name === "displacement") shape.displacement(out);
  else if (name === "stretch") shape.stretch(out);
  else if (name === "pressure") shape.pressure(out, session.state?.tools ?? []);
  else if (name === "strain_energy" && field) field.share.forEach((s, i) => (out[i] = (s / 255) * field.largest));
  else out.fill(0);
  return name !== "strain_energy" || field !== null;
}

/** 1, 2 or 5 times a power of ten, not below x. */
export function nice_above(x: number): number {
  const power = 10 ** Math.floor(Math.log10(x));
  const found = [1, 2, 5, 10].find((step) => step * power >= x * (1 - 1e-9))!;
  return found * power;
}

/** The top of the legend: up at once, down only after the smaller numbers have stayed for some seconds. */
export class Scale {
  top = 0; // in the unit
  private quiet_since_ = 0;

  follow(largest: number, measured: Measure, now_ms: number): number {
    const wanted = Math.max(measured.least, nice_above(Math.max(largest * measured.scale, 1e-12)));
    if (wanted >= this.top || this.top === 0) {
      this.top = wanted;
      this.quiet_since_ = now_ms;
    } else if (largest * measured.scale > this.top * 0.45) {
      this.quiet_since_ = now_ms;
    } else if (now_ms - this.quiet_since_ > 6000) {
      this.top = wanted;
      this.quiet_since_ = now_ms;
    }
    return this.top;
  }

  restart(): void {
    this.top = 0;
  }
}

/** The ramp as a picture, for the legend. */
export function draw_ramp(canvas: HTMLCanvasElement): void {
  const context = canvas.getContext("2d")!;
  const gradient = context.createLinearGradient(0, 0, canvas.width, 0);
  kRamp.forEach((c, i) => {
    gradient.addColorStop(i / (kRamp.length - 1), `rgb(${c.map((v) => Math.round(255 * v)).join(" ")})`);
  });
  context.fillStyle = gradient;
  context.fillRect(0, 0, canvas.width, canvas.height);
}
