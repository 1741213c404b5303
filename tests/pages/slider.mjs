// Drags the sliders of a report in a browser, at six window sizes, by mouse and (on the narrow one) by touch.
//
//   node tests/pages/slider.mjs REPORT [SCENE]
//
// REPORT is a folder that `umbra report` wrote, SCENE one of its folders (default: the first). Needs playwright-core
// (where node finds it, or in the folder that PLAYWRIGHT names) and chromium (CHROMIUM, by default
// /usr/bin/chromium). Exit codes: 0 passed, 1 failed, 77 skipped since one of the two is missing.
import { existsSync, readdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { launch } from "./browser.mjs";

const report = resolve(process.argv[2] || "results");
const scene = process.argv[3] || readdirSync(report).filter((name) => existsSync(join(report, name, "index.html")) && name !== "ladders").sort()[0];

let failed = 0;
function check(what, ok) {
  if (ok) return;
  ++failed;
  console.log(`FAILED ${what}`);
}
const near = (a, b, by) => Math.abs(a - b) <= by;

/** Where everything of the slider is, in pixels of the window. */
const measure = (slider) => slider.evaluate((root) => {
  const box = (e) => { const r = e.getBoundingClientRect(); return { x: r.x, y: r.y, width: r.width, height: r.height }; };
  const left = root.querySelector(".half.left"), divider = root.querySelector(".divider");
  return {
    stage: box(root.querySelector(".stage")), input: box(root.querySelector("input")), value: Number(root.querySelector("input").value),
    images: [...root.querySelectorAll(".half img")].map(box), divider: box(divider).x + box(divider).width / 2,
    clip: Number(/inset\(0(?:px)? ([\d.]+)%/.exec(left.style.clipPath)?.[1]), zoomed: root.querySelector(".stage").classList.contains("zoomed"),
    window: { width: document.documentElement.clientWidth, height: innerHeight, overflow: document.documentElement.scrollWidth - innerWidth },
  };
});

async function drag(page, context, touch, from, to) {
  if (!touch) {
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    await page.mouse.move((from.x + to.x) / 2, from.y, { steps: 4 });
    await page.mouse.move(to.x, to.y, { steps: 4 });
    await page.mouse.up();
    return;
  }
  const session = await context.newCDPSession(page);
  const send = (type, points) => session.send("Input.dispatchTouchEvent", { type, touchPoints: points });
  await send("touchStart", [from]);
  for (let k = 1; k <= 8; ++k) await send("touchMove", [{ x: from.x + (to.x - from.x) * k / 8, y: from.y }]);
  await send("touchEnd", []);
}

async function checkSlider(page, context, where, touch) {
  const slider = page.locator(where.selector);
  await slider.scrollIntoViewIfNeeded();
  const before = await measure(slider), { stage } = before;
  check(`${where.name}: the stage fits into the window`, stage.width <= before.window.width && stage.height <= before.window.height);
  check(`${where.name}: the page is no wider than the window`, before.window.overflow <= 0);
  for (const image of before.images)
    check(`${where.name}: the whole picture is shown`, near(image.x, stage.x, 1) && near(image.y, stage.y, 1) && near(image.width, stage.width, 1) && near(image.height, stage.height, 1));
  check(`${where.name}: it is not zoomed`, !before.zoomed);
  check(`${where.name}: it begins in the middle`, before.value === 50 && near(before.divider, stage.x + stage.width / 2, 1));

  let at = 0.5;
  for (const share of [0.2, 0.85, 0.4]) {
    await slider.scrollIntoViewIfNeeded();
    const now = (await measure(slider)).stage, y = now.y + now.height * 0.3;
    await drag(page, context, touch, { x: now.x + now.width * at, y }, { x: now.x + now.width * share, y });
    const after = await measure(slider);
    check(`${where.name}: a drag to ${share} moves the divider there`, near(after.divider, now.x + now.width * share, 2));
    check(`${where.name}: the pictures part at the divider`, near(after.clip, 100 - 100 * share, 0.5));
    at = share;
  }
  // The thumb is under the divider: the input's value and the place of a click on it agree with the stage.
  for (const share of [0.1, 0.9]) {
    const now = await measure(slider);
    const x = now.stage.x + now.stage.width * share, y = now.input.y + now.input.height / 2;
    await (touch ? page.touchscreen.tap(x, y) : page.mouse.click(x, y));
    check(`${where.name}: the thumb at ${share} is under the divider`, near((await measure(slider)).divider, x, 2));
  }
}

const browser = await launch();
for (const [width, height, touch] of [[1280, 720], [1366, 768], [1440, 900], [1536, 864], [1920, 1080], [390, 844, true]]) {
  const context = await browser.newContext({ viewport: { width, height }, hasTouch: Boolean(touch), isMobile: Boolean(touch) });
  const page = await context.newPage();
  page.on("pageerror", (error) => check(`${width}x${height}: ${error.message}`, false));
  await page.goto(pathToFileURL(join(report, "index.html")).href);
  const lowest = await page.evaluate(() => Math.max(...[...document.querySelectorAll(".front .finding, .front .stage, .front .found img")].map((e) => e.getBoundingClientRect().bottom)));
  check(`${width}x${height}: the sentence and both pictures are above the fold`, lowest <= height);
  await checkSlider(page, context, { name: `${width}x${height} first page`, selector: ".front .slider" }, touch);
  const rows = await page.evaluate(() => document.querySelectorAll(".cards .card").length);
  check(`${width}x${height}: the finder counts the scenes`, (await page.locator("#found").textContent()).includes(` of ${rows} scene`));

  await page.goto(pathToFileURL(join(report, scene, "index.html")).href);
  await checkSlider(page, context, { name: `${width}x${height} ${scene}`, selector: "#compare .slider" }, touch);
  await page.locator("#zoom-in").click();
  check(`${width}x${height} ${scene}: the button zooms`, (await measure(page.locator("#compare .slider"))).zoomed);
  await page.locator("#zoom-fit").click();
  check(`${width}x${height} ${scene}: and fits again`, !(await measure(page.locator("#compare .slider"))).zoomed);
  await context.close();
}
await browser.close();
console.log(failed ? `${failed} checks failed` : "the sliders work at six window sizes");
process.exit(failed ? 1 : 0);
