// A notch of the wheel is a quarter of the tip's radius, and a fortieth with Shift, whatever the browser counts in.
import assert from "node:assert/strict";
import { test } from "node:test";
import { act, type Deeds } from "../src/keys";
import { radii_of } from "../src/wheel";

const kStill = { deltaX: 0, deltaY: 0, deltaMode: 0, shiftKey: false };

function near(found: number, wanted: number): void {
  assert.ok(Math.abs(found - wanted) < 0.01 * Math.abs(wanted), `${found}, not ${wanted}`);
}

test("a notch up pushes the tool away by a quarter of its radius", () => {
  near(radii_of({ ...kStill, deltaY: -100 }), 0.25);
  near(radii_of({ ...kStill, deltaY: 100 }), -0.25);
  near(radii_of({ ...kStill, deltaY: -3, deltaMode: 1 }), 0.2475); // 3 lines of 33 pixels
});

test("with Shift a notch is a tenth of that, also where the browser scrolls sideways", () => {
  near(radii_of({ ...kStill, deltaY: -100, shiftKey: true }), 0.025);
  near(radii_of({ ...kStill, deltaX: -100, shiftKey: true }), 0.025);
});

test("a wheel turned sideways without Shift is no depth", () => {
  assert.equal(Math.abs(radii_of({ ...kStill, deltaX: -100 })), 0);
});

test("a key moves the tool by a notch of the wheel, whatever its tip, and by a tenth of that with Shift", () => {
  const moved: number[][] = [];
  const deeds = { nudge: (...by: number[]) => void moved.push(by) } as unknown as Deeds;
  for (const [key, shiftKey] of [["w", false], ["a", false], ["e", false], ["Q", true]] as const)
    assert.ok(act({ key, shiftKey, repeat: false } as KeyboardEvent, deeds));
  assert.deepEqual(moved.map((by) => by.map((x) => x + 0)), [[0, 0.25, 0], [-0.25, 0, 0], [0, 0, 0.25], [0, 0, -0.025]]);
});
