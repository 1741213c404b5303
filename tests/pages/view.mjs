// Uses `umbra view` as a hand would, in a browser, at 1366 and 390 px: drags a light, turns a bias until there is acne,
// clicks a wrong point; checks which phases are lit, what the page says, and that the server outlives it.
//
//   node tests/pages/view.mjs PROGRAM [PICTURES]
//
// PROGRAM is the built umbra; PICTURES gets a picture of each step. Needs playwright-core (where node finds it, or in the
// folder that PLAYWRIGHT names; with axe-core beside it, accessibility is checked) and chromium (CHROMIUM, by default
// /usr/bin/chromium). Exit codes: 0 passed, 1 failed, 77 skipped since one of the two is missing.
import { spawn } from "node:child_process";
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { axe, launch } from "./browser.mjs";

const [program, pictures] = process.argv.slice(2);
if (pictures) mkdirSync(pictures, { recursive: true });

let failed = 0;
function check(what, ok, found = "") {
  if (ok) return;
  ++failed;
  console.log(`FAILED ${what}${found === "" ? "" : `: ${found}`}`);
}

/** The viewer of a scene, and its address. */
function view(scene, ...methods) {
  const server = spawn(program, ["view", scene, "--methods", ...methods], { stdio: ["ignore", "pipe", "ignore"] });
  return new Promise((done, fail) => {
    let said = "";
    server.stdout.on("data", (text) => {
      said += text;
      const address = /http:\/\/\S+/.exec(said);
      if (address) done({ server, address: address[0] });
    });
    server.on("exit", () => fail(new Error(`umbra view ${scene} ended: ${said}`)));
  });
}
const frames = (page) => page.evaluate(() => Number(document.body.dataset.frames || 0));
const after = (page, before) => page.waitForFunction((n) => Number(document.body.dataset.frames) > n, before, { timeout: 30000, polling: 5 });
/** Until the truth of what is shown now is there, and no further picture comes. */
async function rest(page) {
  let quiet = 0, shown = -1, said = "";
  for (let k = 0; k < 600 && quiet < 10; ++k) {
    await page.waitForTimeout(100);
    const now = await frames(page);
    said = await page.textContent("#errors");
    quiet = now === shown && said.includes("RMSE") ? quiet + 1 : 0;
    shown = now;
  }
  check("the truth comes to rest", quiet === 10, said);
  return said;
}
const lit = (page) => page.evaluate(() => [...new Set([...document.querySelectorAll(".phases td.lit")].map((e) => e.dataset.phase))].join(" "));
async function picture(page, name) { if (pictures) await page.screenshot({ path: join(pictures, `${name}.png`), fullPage: true }); }

async function dragsALight(page, name) {
  const box = await page.locator(".handle.light").first().boundingBox(), times = [];
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  for (let k = 1; k <= 20; ++k) {
    const before = await frames(page);
    await page.mouse.move(box.x + box.width / 2 + 2 * k, box.y + box.height / 2 + k % 7);
    await after(page, before);
    times.push(await page.evaluate(() => Number(document.body.dataset.ms)));
  }
  check(`${name}: a light repeats aim and visibility`, await lit(page) === "aim visibility", await lit(page));
  await page.mouse.up();
  times.sort((a, b) => a - b);
  console.log(`${name}: a light dragged, median ${times[10].toFixed(0)} ms from the hand to the picture`);
  await rest(page);
  await picture(page, `${name}-light`);
  const before = await frames(page);
  await page.focus("#stage");
  await page.keyboard.press("ArrowLeft");
  await after(page, before);
  check(`${name}: a camera repeats look and visibility`, await lit(page) === "look visibility", await lit(page));
}

async function turnsABias(page, name) {
  const acne = (text) => Number((/acne: (\d+)/.exec(text) || [0, 0])[1]);
  const bias = page.locator("#methods label", { hasText: /^constant/ }).locator("input");
  await page.evaluate(() => document.querySelectorAll("#methods details").forEach((d) => { d.open = true; }));
  await page.selectOption("#layer", "classes");
  const quiet = acne(await rest(page));
  let found = quiet;
  for (const value of ["2", "0.5", "0"]) {
    await bias.fill(value);
    found = acne(await rest(page));
    await picture(page, `${name}-bias-${value}`);
  }
  check(`${name}: no bias makes acne`, found > quiet && found > 100, `${quiet} and ${found} points`);
}

async function clicksAWrongPoint(page, name) {
  await page.selectOption("#layer", "classes");
  await rest(page);
  // A pixel in the colour of a class that the page lists.
  const at = await page.evaluate(() => {
    const canvas = document.getElementById("left"), pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    const colours = [...document.querySelectorAll("#errors .swatch")].map((e) => getComputedStyle(e).backgroundColor.match(/\d+/g).map(Number));
    for (let i = 0; i < pixels.length; i += 4)
      if (colours.some((c) => c.every((v, k) => v === pixels[i + k]))) return { x: (i / 4 % canvas.width + 0.5) / canvas.width, y: (Math.floor(i / 4 / canvas.width) + 0.5) / canvas.height };
    return null;
  });
  check(`${name}: a wrong point is in view`, at !== null);
  if (!at) return;
  const stage = await page.locator("#stage").boundingBox();
  await page.mouse.click(stage.x + at.x * stage.width, stage.y + at.y * stage.height);
  await page.waitForFunction(() => document.getElementById("why-text").textContent.length > 0, null, { timeout: 30000 });
  const said = await page.textContent("#why-text");
  check(`${name}: the reason says how it differs from the truth`, said.includes("Unlike the truth"), said);
  await picture(page, `${name}-why`);
}

const browser = await launch();
const steps = [["umbra_penumbra", ["ray_traced"], dragsALight], ["sun_on_plane", ["shadow_zbuffer:bias=manual,constant=4"], turnsABias],
  ["real_dragon", ["shadow_zbuffer:resolution=256"], clicksAWrongPoint], ["umbra_penumbra", ["shadow_volumes"], clicksAWrongPoint]];
for (const [scene, methods, step] of steps) {
  let viewer;
  try {
    viewer = await view(scene, ...methods);
  } catch (error) {
    console.log(`skipped: ${error.message}`);  // a real mesh that is not fetched
    continue;
  }
  for (const [size, width, height] of [["1366", 1366, 768], ["390", 390, 844]]) {
    const name = `${scene}-${step.name}-${size}`, page = await browser.newPage({ viewport: { width, height } });
    page.on("pageerror", (error) => check(`${name}: a script's error`, false, error.message));
    await page.goto(viewer.address);
    await page.waitForFunction(() => Number(document.body.dataset.frames || 0) >= 1, null, { timeout: 30000 });
    await step(page, name);
    check(`${name}: the page is as wide as the window`, await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    if (axe) {
      await page.evaluate(axe);
      const faults = await page.evaluate(() => globalThis.axe.run());
      check(`${name}: axe`, faults.violations.length === 0, faults.violations.map((v) => `${v.id} ${v.nodes[0].html}`).join("; "));
    }
    await page.close();
  }
  check(`${scene}: the server lives on`, viewer.server.exitCode === null);
  viewer.server.removeAllListeners("exit");
  viewer.server.kill("SIGINT");
}
await browser.close();
console.log(failed ? `${failed} failed` : "passed");
process.exit(failed ? 1 : 0);
