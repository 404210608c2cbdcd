// A sample that the page did not get has its place in the plot; one that the server did not make has none.
import assert from "node:assert/strict";
import { test } from "node:test";
import { missed_times } from "../src/series";

test("samples that the page missed stand evenly between those that it got", () => {
  assert.deepEqual(missed_times([1, 2, 6], [0, 0, 3]), [3, 4, 5]);
  assert.deepEqual(missed_times([1, 3], [0, 1]), [2]);
});

test("a gap in which the server made no sample stays empty", () => {
  assert.deepEqual(missed_times([1, 2, 60], [0, 0, 0]), []);
  assert.deepEqual(missed_times([5], [7]), []); // the first that is shown: where those before it were is not known
});
