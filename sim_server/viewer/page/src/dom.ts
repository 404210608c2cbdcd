// Small help with the document, and how numbers are written.

export function by_id<Kind extends HTMLElement = HTMLElement>(id: string): Kind {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as Kind;
}

export function make<Tag extends keyof HTMLElementTagNameMap>(tag: Tag, name = "", text = ""): HTMLElementTagNameMap[Tag] {
  const made = document.createElement(tag);
  if (name) made.className = name;
  if (text) made.textContent = text;
  return made;
}

/** Only if it differs: a text that is set anew is laid out anew. */
export function set_text(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export const kNone = "\u2013";

/** With so many decimals; a dash for what is not known. */
export function fixed(value: number | null | undefined, decimals: number): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return kNone;
  return (Math.abs(value) < 0.5 * 10 ** -decimals ? 0 : value).toFixed(decimals).replace("-", "\u2212");
}

/** Three figures or so, never an exponent in the range that the page meets. */
export function figures(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return kNone;
  const size = Math.abs(value);
  return fixed(value, size >= 100 ? 0 : size >= 10 ? 1 : 2);
}

export function plain_number(value: number): string {
  return String(Number(value.toPrecision(3)));
}

/** m:ss.s */
export function clock(seconds: number): string {
  const minutes = Math.floor(seconds / 60);
  return `${minutes}:${(seconds - 60 * minutes).toFixed(1).padStart(4, "0")}`;
}

/** Offers bytes as a file. */
export function save_file(name: string, blob: Blob): void {
  const link = make("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

let hide_note = 0;

/** A line that goes away by itself; read aloud as well. */
export function note(text: string): void {
  const place = by_id("note");
  place.textContent = text;
  place.hidden = false;
  clearTimeout(hide_note);
  hide_note = setTimeout(() => (place.hidden = true), 5000);
}
