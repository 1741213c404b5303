// Which method the finder of the report's first page marks. Run by node; needs nothing else.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import vm from "node:vm";

const context = vm.createContext({});
vm.runInContext(readFileSync(new URL("../../bench/pages/assets/finder.js", import.meta.url), "utf8"), context);
const { numberIn } = context;
// An array of this realm, so that deepEqual compares values alone.
const cheapest = (methods, limits, noise = NaN) => [...context.cheapest(methods, limits, noise)];

const none = { mae: NaN, cover: NaN };
const method = (mae, ms, interior = 0, cover = 1) => ({ mae, ms, interior, cover });

test("the cheapest within the limits wins", () => {
  const methods = [method(0.1, 1), method(0.001, 5), method(0, 9)];
  assert.deepEqual(cheapest(methods, { mae: 0.01, cover: 99 }), [1]);
  assert.deepEqual(cheapest(methods, { mae: 0, cover: 99 }), [2]);
  assert.deepEqual(cheapest(methods, { mae: 0.5, cover: 99 }), [0]);
});

test("a method with wrong interior points wins only where all have some", () => {
  assert.deepEqual(cheapest([method(0.0001, 1, 3115), method(0.001, 80)], none), [1]);
  assert.deepEqual(cheapest([method(0.0001, 1, 3115), method(0.001, 80, 2)], none), [0]);
  assert.deepEqual(cheapest([method(0.0001, 1, 3115), method(0.5, 80)], { mae: 0.01, cover: NaN }), [0]);
});

test("an empty field limits nothing", () => {
  assert.ok(Number.isNaN(numberIn("")) && Number.isNaN(numberIn("  ")) && Number.isNaN(numberIn(undefined)));
  assert.equal(numberIn("0"), 0);
  assert.deepEqual(cheapest([method(0.9, 1)], { mae: numberIn(""), cover: numberIn("") }), [0]);
  assert.deepEqual(cheapest([method(0.9, 1)], { mae: numberIn("0"), cover: NaN }), []);
});

test("coverage limits, and what was not measured never wins", () => {
  assert.deepEqual(cheapest([method(0, 1, 0, 0.8), method(0, 5)], { mae: NaN, cover: 99 }), [1]);
  assert.deepEqual(cheapest([method(0, NaN), method(NaN, 1)], { mae: 0.1, cover: NaN }), []);
  assert.deepEqual(cheapest([], none), []);
});

test("all that noise does not tell from the least time win", () => {
  const methods = [method(0, 2.4), method(0, 2), method(0.1, 1), method(0, 2.5)];
  const limits = { mae: 0.01, cover: NaN };
  assert.deepEqual(cheapest(methods, limits, 0.2), [0, 1]);
  assert.deepEqual(cheapest(methods, limits, 0.1), [1]);
  assert.deepEqual(cheapest(methods, limits, 0.25), [0, 1, 3]);
  assert.deepEqual(cheapest(methods, limits, NaN), [1]);
  assert.deepEqual(cheapest(methods, limits, Infinity), [0, 1, 3]);
});
