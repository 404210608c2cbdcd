// Colours and motion as the reader wants them: the style sheet has them, the picture and the plots ask here.
import kLawColours from "../../../../common/law_colours.json";

const kLight = matchMedia("(prefers-color-scheme: light)");
const kStill = matchMedia("(prefers-reduced-motion: reduce)");

/** A colour of the style sheet, such as "--force". */
export function colour_of(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim() || "#888888";
}

/** The colour that a law has everywhere: here, in pictures and in studies. */
export function law_colour(name: string): string {
  const found = (kLawColours as Record<string, { light: string; dark: string }>)[name];
  return found?.[kLight.matches ? "light" : "dark"] ?? colour_of("--muted");
}

export function on_theme_change(react: () => void): void {
  kLight.addEventListener("change", react);
}

export function wants_little_motion(): boolean {
  return kStill.matches;
}
