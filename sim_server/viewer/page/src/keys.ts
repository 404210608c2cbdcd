// The keyboard: the habits of MuJoCo's users, and everything that the mouse can do. The list that h shows is this table.
import { radii_of_notch } from "./wheel";

export interface Deeds {
  pause(): void;
  step(by: 1 | -1): void;
  next_look(by: 1 | -1): void;
  next_measure(): void;
  home(): void;
  zoom(factor: number): void;
  turn(yaw: number, pitch: number): void;
  nudge(right: number, up: number, away: number): void; // by shares of the tip's radius
  grip(held: boolean): void;
  choose_tool(number: number): void;
  picture(): void;
  video(): void;
  share(): void;
  help(): void;
}

export const kKeys: [string[], string][] = [
  [["Space"], "pause and go on; with motors, the force fades first"],
  [["\u2192"], "one step, while paused; in a recording \u2190 goes back"],
  [["Tab"], "next drawing: surface, edges, regions, glass (Esc leaves the picture)"],
  [["C"], "next measure to colour by"],
  [["R"], "reset the view"],
  [["Shift", "arrows"], "turn the view"],
  [["+", "\u2212"], "zoom"],
  [["W", "A", "S", "D"], "move the tool up, left, down, right by a quarter of its tip's radius"],
  [["E", "Q"], "push the tool away, pull it nearer"],
  [["Shift", "W", "\u2026", "Q"], "the same by a tenth of that"],
  [["G"], "hold: close the grip"],
  [["1", "\u2026", "8"], "which tool the keys move"],
  [["P", "V", "L"], "picture, video, share"],
  [["H", "?"], "these keys"],
];

const kTurn = 0.1; // rad
const kSteps: Record<string, [number, number, number]> = {
  w: [0, 1, 0], // right, up, away
  s: [0, -1, 0],
  a: [-1, 0, 0],
  d: [1, 0, 0],
  e: [0, 0, 1],
  q: [0, 0, -1],
};

export function listen_to_keys(canvas: HTMLCanvasElement, deeds: Deeds): void {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || typing(event.target)) return;
    const on_button = event.target instanceof HTMLButtonElement || event.target instanceof HTMLAnchorElement;
    if (on_button && (event.key === " " || event.key === "Enter")) return; // they press the button
    if (event.key === "Escape" && event.target === canvas) canvas.blur();
    if (event.key === "Tab" && event.target !== canvas) return; // the browser's own way round the page
    if (act(event, deeds)) event.preventDefault();
  });
  document.addEventListener("keyup", (event) => {
    if (event.key.toLowerCase() === "g") deeds.grip(false);
  });
  window.addEventListener("blur", () => deeds.grip(false));
}

function typing(target: EventTarget | null): boolean {
  return target instanceof HTMLInputElement || target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement;
}

export function act(event: KeyboardEvent, deeds: Deeds): boolean {
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (event.shiftKey && turn(key, deeds)) return true;
  if (/^[1-8]$/.test(key)) deeds.choose_tool(Number(key) - 1);
  else if (key === " ") event.repeat || deeds.pause();
  else if (key === "ArrowRight") deeds.step(1);
  else if (key === "ArrowLeft") deeds.step(-1);
  else if (key === "Tab") deeds.next_look(event.shiftKey ? -1 : 1);
  else if (key === "c") deeds.next_measure();
  else if (key === "r") deeds.home();
  else if (key === "+" || key === "=") deeds.zoom(0.9);
  else if (key === "-") deeds.zoom(1.1);
  else if (key in kSteps) step(kSteps[key], event.shiftKey, deeds);
  else if (key === "g") deeds.grip(true);
  else if (key === "p") deeds.picture();
  else if (key === "v") deeds.video();
  else if (key === "l") deeds.share();
  else if (key === "h" || key === "?") deeds.help();
  else return false;
  return true;
}

/** By a press, in shares of the tip's radius: a notch of the wheel, which with Shift is finer. */
function step([right, up, away]: [number, number, number], fine: boolean, deeds: Deeds): void {
  const size = radii_of_notch(fine);
  deeds.nudge(size * right, size * up, size * away);
}

function turn(key: string, deeds: Deeds): boolean {
  if (key === "ArrowRight") deeds.turn(kTurn, 0);
  else if (key === "ArrowLeft") deeds.turn(-kTurn, 0);
  else if (key === "ArrowUp") deeds.turn(0, kTurn);
  else if (key === "ArrowDown") deeds.turn(0, -kTurn);
  else return false;
  return true;
}

/** The list of keys, into an empty dl. */
export function list_keys(list: HTMLElement): void {
  for (const [keys, meaning] of kKeys) {
    const term = document.createElement("dt");
    for (const key of keys) {
      const one = document.createElement(key === "arrows" || key === "\u2026" ? "span" : "kbd");
      one.textContent = key;
      term.append(one, " ");
    }
    const said = document.createElement("dd");
    said.textContent = meaning;
    list.append(term, said);
  }
}
