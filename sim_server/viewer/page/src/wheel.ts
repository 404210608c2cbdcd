// How far a turn of the wheel takes a tool away from the camera: by a share of its tip's radius. A notch of a whole radius or
// more pushes the tip through elements of linear tissue at once, and turns them inside out.
export interface Turn {
  deltaX: number;
  deltaY: number;
  deltaMode: number; // 0: pixels, 1: lines, 2: pages
  shiftKey: boolean;
}

const kNotch = 100; // pixels that a notch scrolls
const kShare = 0.25; // of the radius, a notch
const kFine = 0.1; // of that, with Shift

/** Pixels that the wheel would scroll; with Shift, some browsers scroll sideways. */
export function pixels_of(turn: Turn): number {
  const pixels = turn.deltaY === 0 && turn.shiftKey ? turn.deltaX : turn.deltaY;
  return pixels * (turn.deltaMode === 1 ? 33 : turn.deltaMode === 2 ? 400 : 1);
}

/** Of the tip's radius: a notch of the wheel, or a press of a key. */
export function radii_of_notch(fine: boolean): number {
  return kShare * (fine ? kFine : 1);
}

/** Shares of the tip's radius. Up, away from the one who turns it, pushes the tool away as well. */
export function radii_of(turn: Turn): number {
  return (-pixels_of(turn) / kNotch) * radii_of_notch(turn.shiftKey);
}
