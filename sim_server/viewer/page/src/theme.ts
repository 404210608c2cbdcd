// Colours and motion as the reader wants them: the style sheet has them, the picture and the plots ask here.

const kLight = matchMedia("(prefers-color-scheme: light)");
const kStill = matchMedia("(prefers-reduced-motion: reduce)");

/** A colour of the style sheet, such as "--force". */
export function colour_of(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim() || "#888888";
}

/** The colour of a law by its place in the list. */
export function law_colour(index: number): string {
  return colour_of(`--law-${(index % 8) + 1}`);
}

export function on_theme_change(react: () => void): void {
  kLight.addEventListener("change", react);
}

export function wants_little_motion(): boolean {
  return kStill.matches;
}
