// Which method the finder of the report's first page marks. Run by node; needs nothing else.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import vm from "node:vm";

const context = vm.createContext({});
vm.runInContext(readFileSync(new URL("../../bench/pages/assets/finder.js", import.meta.url), "utf8"), context);
const { cheapest, numberIn } = context;

const none = { mae: NaN, cover: NaN };
const method = (mae, ms, interior = 0, cover = 1) => ({ mae, ms, interior, cover });

test("the cheapest within the limits wins", () => {
  const methods = [method(0.1, 1), method(0.001, 5), method(0, 9)];
  assert.equal(cheapest(methods, { mae: 0.01, cover: 99 }), 1);
  assert.equal(cheapest(methods, { mae: 0, cover: 99 }), 2);
  assert.equal(cheapest(methods, { mae: 0.5, cover: 99 }), 0);
});

test("a method with wrong interior points wins only where all have some", () => {
  assert.equal(cheapest([method(0.0001, 1, 3115), method(0.001, 80)], none), 1);
  assert.equal(cheapest([method(0.0001, 1, 3115), method(0.001, 80, 2)], none), 0);
  assert.equal(cheapest([method(0.0001, 1, 3115), method(0.5, 80)], { mae: 0.01, cover: NaN }), 0);
});

test("an empty field limits nothing", () => {
  assert.ok(Number.isNaN(numberIn("")) && Number.isNaN(numberIn("  ")) && Number.isNaN(numberIn(undefined)));
  assert.equal(numberIn("0"), 0);
  assert.equal(cheapest([method(0.9, 1)], { mae: numberIn(""), cover: numberIn("") }), 0);
  assert.equal(cheapest([method(0.9, 1)], { mae: numberIn("0"), cover: NaN }), -1);
});

test("coverage limits, and what was not measured never wins", () => {
  assert.equal(cheapest([method(0, 1, 0, 0.8), method(0, 5)], { mae: NaN, cover: 99 }), 1);
  assert.equal(cheapest([method(0, NaN), method(NaN, 1)], { mae: 0.1, cover: NaN }), -1);
  assert.equal(cheapest([], none), -1);
});
