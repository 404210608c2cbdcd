// What the picture's colours, arrows and lengths stand for, and the choice of what is drawn.
import { draw_ramp, kMeasures, nice_above, rest_moved } from "./colours";
import { by_id, plain_number, set_text } from "./dom";
import { kLooks, type Look } from "./organ";
import type { Session } from "./session";
import type { View } from "./view";

const kLookLabels: Record<Look, string> = { surface: "Surface", edges: "Surface and edges", regions: "Regions", glass: "Glass" };

export class Legend {
  private readonly measures_ = by_id<HTMLSelectElement>("measures");
  private readonly looks_ = by_id<HTMLSelectElement>("looks");

  constructor(
    private readonly view_: View,
    private readonly session_: Session,
    private readonly want_: (field: string | null) => void,
  ) {
    draw_ramp(by_id<HTMLCanvasElement>("ramp"));
    for (const look of kLooks) this.looks_.append(new Option(kLookLabels[look], look));
    this.looks_.onchange = () => this.set_look(this.looks_.value as Look);
    this.measures_.onchange = () => this.set_measure(this.measures_.value);
    this.scene();
  }

  /** Another scene: it may know other fields. */
  scene(): void {
    const fields = this.session_.scene?.fields ?? [];
    const offered = kMeasures.filter((m) => m.name !== "strain_energy" || fields.includes(m.name));
    this.measures_.replaceChildren(...offered.map((m) => new Option(m.label, m.name)));
    const kept = offered.find((m) => m.name === this.view_.measure.name) ?? offered[0];
    this.set_measure(kept.name);
  }

  want(): void {
    if (this.view_.measure.name !== "strain_energy") this.session_.field = null; // it will be old
    this.want_(this.view_.measure.name === "strain_energy" ? "strain_energy" : null);
  }

  next_look(by: 1 | -1): void {
    const at = kLooks.indexOf(this.view_.look);
    this.set_look(kLooks[(at + by + kLooks.length) % kLooks.length]);
  }

  next_measure(): void {
    const options = this.measures_.options;
    this.set_measure(options[(this.measures_.selectedIndex + 1) % options.length].value);
  }

  /** After the picture was drawn. */
  draw(): void {
    const { measure, top, measured, newtons, arrow_metres, orbit, height } = this.view_;
    const plain = measure.name === "plain";
    by_id("scale").hidden = plain || !measured;
    by_id("scale-note").hidden = plain || measured;
    set_text(by_id("scale-note"), rest_moved(this.session_) ? "not known after a blade has cut" : "no numbers yet");
    set_text(by_id("scale-middle"), plain_number(top / 2));
    set_text(by_id("scale-top"), `${plain_number(top)} ${measure.unit}`);
    const metres = orbit.metres_per_pixel(height);
    const length = nice_above(50 * metres);
    this.bar("length", length / metres, `${plain_number(1e3 * length)} mm`);
    const pixels_per_newton = arrow_metres / metres / newtons;
    const shown = nice_above(50 / pixels_per_newton);
    this.bar("force", shown * pixels_per_newton, `${plain_number(shown)} N`);
  }

  private bar(name: string, pixels: number, text: string): void {
    by_id(`${name}-bar`).style.width = `${pixels.toFixed(1)}px`;
    set_text(by_id(`${name}-text`), text);
  }

  private set_look(look: Look): void {
    this.looks_.value = look;
    by_id("regions").hidden = look !== "regions";
    this.view_.set_look(look);
  }

  private set_measure(name: string): void {
    this.measures_.value = name;
    this.view_.set_measure(kMeasures.find((m) => m.name === name)!);
    this.want();
  }
}
