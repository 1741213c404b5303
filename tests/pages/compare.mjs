// Uses the section "Compare pictures" of scene pages in a browser: on a wide window by mouse and keys, on a narrow one by
// touch. What it must show is read from values.js here, by a decoder of its own.
//
//   node tests/pages/compare.mjs REPORT [SCENE...]
//
// REPORT is a folder that `umbra report` wrote, SCENE some of its folders (default: the first two with a values.js).
// Needs playwright-core (where node finds it, or in the folder that PLAYWRIGHT names) and chromium (CHROMIUM, by default
// /usr/bin/chromium); checks accessibility too where axe-core lies beside playwright-core. Exit codes: 0 passed,
// 1 failed, 77 skipped since something is missing.
import { cpSync, existsSync, mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { inflateSync } from "node:zlib";
import { axe, launch, skip } from "./browser.mjs";

const report = resolve(process.argv[2] || "results");
const withValues = existsSync(report) ? readdirSync(report).filter((name) => existsSync(join(report, name, "values.js"))).sort() : [];
const scenes = process.argv.length > 3 ? process.argv.slice(3) : withValues.slice(0, 2);
if (!scenes.length) skip(`no scene of ${report} has a values.js`);

let failed = 0, done = 0, where = "";
function check(what, ok, seen) {
  ++done;
  if (ok) return;
  ++failed;
  console.log(`FAILED ${where}: ${what}${seen === undefined ? "" : `; seen: ${JSON.stringify(seen)}`}`);
}

/** An RGB PNG of a data: URL, decoded with all five filters. */
function decode(url) {
  const file = Buffer.from(url.split(",")[1], "base64"), parts = [];
  let width = 0, height = 0;
  for (let at = 8; at < file.length;) {
    const size = file.readUInt32BE(at), kind = file.toString("latin1", at + 4, at + 8), data = file.subarray(at + 8, at + 8 + size);
    if (kind === "IHDR") { [width, height] = [data.readUInt32BE(0), data.readUInt32BE(4)]; if (data[8] !== 8 || data[9] !== 2 || data[12]) throw new Error("not a plain RGB picture"); }
    if (kind === "IDAT") parts.push(data);
    at += 12 + size;
  }
  const raw = inflateSync(Buffer.concat(parts)), line = 3 * width, out = new Uint8Array(line * height);
  const paeth = (a, b, c) => { const p = a + b - c, [x, y, z] = [a, b, c].map((v) => Math.abs(p - v)); return x <= y && x <= z ? a : y <= z ? b : c; };
  for (let y = 0; y < height; ++y) {
    const filter = raw[y * (line + 1)];
    for (let k = 0; k < line; ++k) {
      const left = k < 3 ? 0 : out[y * line + k - 3], up = y ? out[(y - 1) * line + k] : 0, corner = y && k >= 3 ? out[(y - 1) * line + k - 3] : 0;
      out[y * line + k] = raw[y * (line + 1) + 1 + k] + [0, left, up, (left + up) >> 1, paeth(left, up, corner)][filter];
    }
  }
  return out;
}

/** What values.js says, point by point. */
function readValues(file) {
  let data;
  new Function("umbraValues", readFileSync(file, "utf8"))((d) => { data = d; });
  const pictures = new Map(), picture = (url) => pictures.get(url) || pictures.set(url, decode(url)).get(url), faces = decode(data.faces);
  const at = (who, light, i) => {
    const p = picture(data.columns.find((c) => c.who === who).planes[data.lights.indexOf(light)]);
    return { s: p[3 * i], class: p[3 * i + 1], answered: p[3 * i + 2] === 255 };
  };
  const truthOf = (who) => data.columns.find((c) => c.who === who).truth;  // a reference has none
  return {
    ...data, at, truthOf, whos: data.columns.map((c) => c.who), methods: data.columns.filter((c) => c.truth).map((c) => c.who),
    face: (i) => (faces[3 * i] << 16 | faces[3 * i + 1] << 8 | faces[3 * i + 2]) - 1,
    /** The compared points of a rectangle: their differences, in 255ths, and classes. */
    compared(who, light, box = { x: 0, y: 0, w: data.width, h: data.height }) {
      const found = [];
      for (let y = box.y; y < box.y + box.h; ++y) {
        for (let x = box.x; x < box.x + box.w; ++x) {
          const a = at(who, light, y * data.width + x), b = at(truthOf(who) || who, light, y * data.width + x);
          if (a.class >= 6 && a.class !== 18 && a.answered && b.answered) found.push({ d: a.s - b.s, class: a.class });
        }
      }
      return found;
    },
  };
}
const isWrong = (c) => c >= 8 && c <= 17;
const signed = (d) => (Math.abs(d) < 0.0005 ? "0.000" : (d < 0 ? "−" : "+") + Math.abs(d).toFixed(3));

const browser = await launch();

/** The section on a page: what a person does there, and what it then shows. */
class Section {
  constructor(page) { this.page = page; }
  async open(folder, hash = "") {
    await this.page.goto("about:blank");
    await this.page.goto(pathToFileURL(join(folder, "index.html")).href + hash);
  }
  /** Frames are drawn, planes decoded, and the address is written. */
  async settle() { await this.page.waitForTimeout(350); }
  async values() {
    await this.page.locator("#compare .stage").focus();
    await this.page.keyboard.press("Shift");
    await this.page.waitForFunction(() => !document.getElementById("values").hidden && document.getElementById("mask-count").textContent, null, { timeout: 10000 });
    await this.settle();
  }
  text(id) { return this.page.locator("#" + id).textContent(); }
  value(id) { return this.page.locator("#" + id).inputValue(); }
  set(id, value) { return this.page.locator("#" + id).selectOption(value); }
  async press(...keys) {
    await this.page.locator("#compare .stage").focus();
    for (const key of keys) await this.page.keyboard.press(key);
    await this.page.waitForTimeout(60);
  }
  rows() { return this.page.locator("#value-rows tr").evaluateAll((rows) => rows.map((row) => [...row.cells].map((cell) => cell.textContent))); }
  async pixel() { const m = /^Pixel (\d+), (\d+)/.exec(await this.text("pixel")); return m && { x: Number(m[1]), y: Number(m[2]) }; }
  /** Where a pixel's middle is in the window, in one of the panes. */
  place(x, y, pane = 0) {
    return this.page.locator("#compare .half img").nth(pane).evaluate((image, { x, y }) => {
      const b = image.getBoundingClientRect(), w = Number(image.getAttribute("width"));
      return { x: b.left + (x + 0.5) * b.width / w, y: b.top + (y + 0.5) * b.width / w };
    }, { x, y });
  }
  overflow() { return this.page.evaluate(() => document.documentElement.scrollWidth - innerWidth); }
  async accessible(what) {
    if (!axe) return;
    await this.page.evaluate(axe);
    const found = await this.page.evaluate(async () => (await window.axe.run("#compare", { preload: false })).violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.target).join(" ")}`));
    check(`axe finds nothing in ${what}`, !found.length, found);
  }
}

/** A pixel's row of the table and its surface. */
async function checkPixel(section, v, light, p) {
  const i = p.y * v.width + p.x, rows = await section.rows(), said = await section.text("pixel"), face = v.face(i);
  let first = 0;
  const on = face < 0 ? null : v.objects.find(([, n]) => (face < first + n) || ((first += n), false));
  check(`the surface at ${p.x}, ${p.y}`, said === `Pixel ${p.x}, ${p.y}: ${on ? `triangle ${face - first} of ${on[0]}` : "no surface"}.`, said);
  check("a row a method", rows.length === v.whos.length, rows.length);
  for (const [k, who] of v.whos.entries()) {
    const a = v.at(who, light, i), given = a.answered && a.class > 0;
    check(`S of ${who} at ${p.x}, ${p.y}`, rows[k][0] === who && rows[k][1] === (given ? (a.s / 255).toFixed(3) : a.class ? "no answer" : "–"), rows[k]);
    const isMethod = v.methods.includes(who), truth = v.at(v.truthOf(who) || who, light, i), difference = given && isMethod && truth.answered;
    check(`difference of ${who} at ${p.x}, ${p.y}`, rows[k][2] === (difference ? signed((a.s - truth.s) / 255) : "–"), rows[k]);
    if (isMethod) check(`class of ${who} at ${p.x}, ${p.y}`, await section.page.evaluate(([name, word]) => kClasses[name][0] === word, [v.classes[a.class], rows[k][3]]), rows[k]);
  }
}

/** The method with the most wrong points under a light, to have something to look at. */
function worst(v) {
  const count = (who, light) => v.compared(who, light).filter((p) => isWrong(p.class)).length;
  return v.lights.flatMap((light) => v.whos.slice(1).map((who) => ({ who, light, wrong: count(who, light) }))).sort((a, b) => b.wrong - a.wrong)[0];
}

async function checkWide(section, folder, v) {
  const { page } = section, { who, light } = worst(v), other = v.methods.find((w) => w !== who);
  await section.open(folder);
  check("the address is left alone", !(await page.evaluate(() => location.hash)));
  await section.values();
  await section.set("left-who", who);
  await section.set("compare-light", light);
  await section.settle();

  // Values: by pointer, and by key from pixel to pixel.
  const points = Array.from({ length: 10 }, (_, k) => ({ x: (37 * k + 11) % v.width, y: Math.floor((k + 0.5) * v.height / 10) }));
  const wrong = [...Array(v.width * v.height).keys()].filter((i) => isWrong(v.at(who, light, i).class));
  for (let k = 0; k < Math.min(10, wrong.length); ++k) { const i = wrong[Math.floor(k * wrong.length / 10)]; points.push({ x: i % v.width, y: Math.floor(i / v.width) }); }
  for (const p of points) {
    const at = await section.place(p.x, p.y);
    await page.mouse.move(at.x, at.y);
    await page.waitForTimeout(60);
    await checkPixel(section, v, light, p);
  }
  await page.mouse.move(1, 1);
  await section.press("Shift+ArrowRight", "Shift+ArrowRight", "Shift+ArrowDown");
  const at = await section.pixel();
  check("Shift and arrows move the crosshair", at && at.x === Math.floor(v.width / 2) + 1 && at.y === Math.floor(v.height / 2) + 1, at);
  await checkPixel(section, v, light, at);
  check("and it is said", (await section.text("said")).includes(`Pixel ${at.x}, ${at.y}`));

  // The light follows the picture, and the pictures the light.
  await section.set("left-what", "S of " + v.lights.at(-1));
  check("the light follows the picture", await section.value("compare-light") === v.lights.at(-1));
  await section.set("compare-light", light);
  check("the picture follows the light", await section.value("left-what") === "S of " + light);
  await section.set("left-what", "picture");

  // Keys.
  const whos = await page.locator("#left-who option").evaluateAll((options) => options.map((o) => o.value));
  await section.press("Digit2", "Shift+Digit1");
  check("2 chooses the second method on the left, Shift+1 the first on the right", await section.value("left-who") === whos[1] && await section.value("right-who") === whos[0]);
  await section.press("f");
  check("f flips", await section.value("left-who") === whos[0] && await section.value("right-who") === whos[1]);
  await section.press("f");
  const sources = () => page.locator("#compare .half img").evaluateAll((images) => images.map((image) => image.src));
  const before = await sources();
  await page.keyboard.down("r");
  await page.waitForTimeout(60);
  check("r shows the reference on both sides", (await sources()).every((src) => src.endsWith("/reference.png")), await sources());
  await page.keyboard.up("r");
  await page.waitForTimeout(60);
  check("and lets go of it", (await sources()).join() === before.join());
  await section.press("e", "e", "Shift+E");
  check("e and Shift+E change the exposure", await section.text("exposure") === "+0.5 EV" && await page.locator("#compare .half img").first().evaluate((image) => image.style.filter.startsWith("brightness(1.1")), await section.text("exposure"));
  await section.press("o");
  check("o resets it", await section.text("exposure") === "" && await page.locator("#compare .half img").first().evaluate((image) => image.style.filter === ""));
  await section.press("+");
  check("+ zooms", await section.text("zoom-now") !== "fit");
  await section.press("0");
  check("0 fits", await section.text("zoom-now") === "fit");

  // The mask.
  await section.set("left-who", who);
  for (const least of [0, 0.1, 0.2, 0.6, 1]) {
    await page.locator("#mask-least").evaluate((input, value) => { input.value = value; input.dispatchEvent(new Event("input", { bubbles: true })); }, least);
    await section.settle();
    const all = v.compared(who, light), marked = all.filter((p) => 100 * Math.abs(p.d) > 255 * Math.round(100 * least)).length;
    check(`the mask of ${least}`, (await section.text("mask-count")).startsWith(`${marked} of ${all.length} compared points`), await section.text("mask-count"));
  }
  check("moving the threshold switches the mask on", await page.locator("#mask-on").isChecked());

  // A region: Alt and drag, then by the button, then by keys.
  const facts = () => page.locator("#region-facts").evaluate((list) => Object.fromEntries([...list.querySelectorAll("dt")].map((dt) => [dt.textContent, dt.nextSibling.textContent])));
  const checkRegion = async (how, box) => {
    await section.settle();
    const seen = await facts(), all = v.compared(who, light, box), n = all.length, largest = all.reduce((m, p) => Math.max(m, Math.abs(p.d)), 0) / 255;
    const mean = all.reduce((sum, p) => sum + Math.abs(p.d), 0) / 255 / n, rmse = Math.sqrt(all.reduce((sum, p) => sum + p.d * p.d, 0) / n) / 255;
    const digits = (x) => (n ? x.toFixed(4) : "–");
    check(`the region ${how}`, seen.Region === `${box.w} × ${box.h} pixels from ${box.x}, ${box.y}` && seen.Compared === `${n} points`, seen);
    check(`its errors (${how})`, seen["Mean |difference|"] === digits(mean) && seen.RMSE === digits(rmse) && seen["Largest difference"].replace(/^[−+]/, "") === digits(largest), seen);
    const sign = { "−": -1, "+": 1 }[seen["Largest difference"][0]];
    check(`the sign of the largest (${how})`, !sign || all.some((p) => p.d === Math.round(sign * largest * 255)), seen);
    const wrong = new Map();
    for (const p of all) if (isWrong(p.class)) wrong.set(p.class, (wrong.get(p.class) || 0) + 1);
    const words = await page.evaluate((list) => list.map(([name, k]) => `${k} ${kClasses[name][0]}`).join("; "), [...wrong].sort((a, b) => a[0] - b[0]).map(([c, k]) => [v.classes[c], k]));
    check(`its wrong points (${how})`, seen.Wrong === (words || "none"), seen.Wrong);
  };
  const drag = async (a, b) => {
    const from = await section.place(a.x, a.y), to = await section.place(b.x, b.y);
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    await page.mouse.move(to.x, to.y, { steps: 5 });
    await page.mouse.up();
  };
  const box = { x: Math.floor(v.width / 5), y: Math.floor(v.height / 3), w: Math.floor(v.width / 2), h: Math.floor(v.height / 2) };
  await page.locator("#compare .stage").scrollIntoViewIfNeeded();
  await page.keyboard.down("Alt");
  await drag(box, { x: box.x + box.w - 1, y: box.y + box.h - 1 });
  await page.keyboard.up("Alt");
  await checkRegion("by Alt and drag", box);
  await section.press("Escape");
  check("Escape clears it", await page.locator("#region-facts").isHidden());
  await page.locator("#region-on").click();
  await page.locator("#compare .stage").scrollIntoViewIfNeeded();
  await drag({ x: box.x + box.w - 1, y: box.y + box.h - 1 }, box);
  await checkRegion("by the button", box);
  await section.press("Escape");
  await page.locator("#region-on").click();
  await page.mouse.move(1, 1);  // so that the crosshair's pixel is shown
  await page.waitForTimeout(60);
  const from = await section.pixel();
  await section.press("Shift+ArrowRight", "Shift+ArrowRight", "Shift+ArrowDown");
  await checkRegion("by keys", { x: from.x, y: from.y, w: 3, h: 2 });
  await section.press("Escape");

  // Jumps.
  const classes = new Map();
  for (let i = 0; i < v.width * v.height; ++i) { const c = v.at(who, light, i).class; if (isWrong(c)) classes.set(v.classes[c], (classes.get(v.classes[c]) || 0) + 1); }
  const offered = await page.locator("#wrong-class option").evaluateAll((options) => options.slice(1).map((o) => [o.value, Number(/\((\d+)\)$/.exec(o.textContent)[1])]));
  check("the classes and their counts", JSON.stringify(offered) === JSON.stringify(v.classes.filter((c) => classes.has(c)).map((c) => [c, classes.get(c)])), offered);
  for (const [name, n] of offered) {
    await section.set("wrong-class", name);
    await section.settle();
    const seen = new Set();
    for (let k = 0; k < 3; ++k) {
      await section.press("n");
      const p = await section.pixel();
      seen.add(`${p.x},${p.y}`);
      check(`a jump to ${name}`, v.classes[v.at(who, light, p.y * v.width + p.x).class] === name, p);
    }
    check(`jumps to ${name} go on`, seen.size === Math.min(n, 3), [...seen]);
    await section.press("n", "Shift+N");
    check(`and back to ${name}`, v.classes[v.at(who, light, (await section.pixel()).y * v.width + (await section.pixel()).x).class] === name);
  }
  if (offered.length) {
    check("a jump zooms to 8 at least", Number.parseFloat(await section.text("zoom-now")) >= 8 || await section.text("zoom-now") === "fit");
    const p = await section.pixel(), there = await section.place(p.x, p.y);
    check("the point is in sight", await page.evaluate(({ x, y }) => document.elementFromPoint(x, y)?.closest(".stage") !== null, there));
  }

  // Numbers in the pixels: something is drawn over the picture from 32 on.
  const inked = () => page.locator("#compare .half.left canvas").evaluate((c) => { const d = c.getContext("2d").getImageData(0, 0, c.width, c.height).data; let n = 0; for (let k = 3; k < d.length; k += 4) n += d[k] > 0; return n; });
  await page.locator("#mask-on").uncheck();
  await section.set("left-what", "S of " + light);
  await page.keyboard.press("Escape");
  await section.press("0", "+", "+", "+", "+", "+", "+", "+", "-", "-");
  await section.settle();
  const few = await inked();
  await section.press("+");
  await section.settle();
  check("numbers stand in the pixels at 32", await section.text("zoom-now") === "32 ×" && await inked() > few + 1000, [await section.text("zoom-now"), few, await inked()]);
  await section.press("+", "+");
  check("64 is the largest zoom", await section.text("zoom-now") === "64 ×" && await page.locator("#zoom-in").isDisabled());
  await section.press("0");

  // Layouts: panes are linked.
  for (const [layout, n] of [["2", 2], ["4", 4], ["slider", 2]]) {
    await section.set("compare-layout", layout);
    await section.settle();
    await section.press("+", "+");
    const boxes = await page.locator("#compare .half img").evaluateAll((images) => images.map((i) => [i.style.left, i.style.top, i.style.width].join()));
    check(`layout ${layout} has ${n} linked panes`, boxes.length === n && new Set(boxes).size === 1, boxes);
    check(`layout ${layout} is no wider than the window`, await section.overflow() <= 0);
    await section.accessible(`layout ${layout}`);
    await section.press("0");
  }
  await section.set("compare-layout", "4");
  check("the third and the fourth pane show further methods", new Set(await page.locator("#left-who, #right-who, #third-who, #fourth-who").evaluateAll((all) => all.map((s) => s.value))).size === Math.min(4, whos.length));

  // The address.
  await section.set("right-who", other || "Reference");
  await section.set("right-what", "S of " + light);
  await page.locator("#mask-on").check();
  await section.press("+", "+", "Shift+ArrowRight", "e");
  await section.settle();
  await section.settle();
  const look = () => page.evaluate(() => JSON.stringify([...document.querySelectorAll("#compare select, #compare input, #zoom-now, #exposure, #pixel, #mask-count, #compare .half img")].map((e) => (e.matches("img") ? e.src.split("/").pop() + e.style.left + e.style.top + e.style.filter : e.matches("select, input") ? `${e.value} ${e.checked}` : e.textContent))));
  const kept = await look();
  await page.reload();
  await page.waitForFunction(() => document.getElementById("mask-count").textContent);
  await section.settle();
  check("a reload restores the view", await look() === kept, JSON.parse(await look()).filter((text, k) => text !== JSON.parse(kept)[k]));
  await section.open(folder, "#errors");
  check("plain anchors stay", await page.evaluate(() => Math.abs(document.getElementById("errors").getBoundingClientRect().top) < innerHeight && location.hash === "#errors"));

  for (const hostile of ["#left=<img src=x onerror=alert(1)>&zoom=1e99&at=NaN", "#left=%3Cscript%3Ealert(1)%3C/script%3E&leftWhat=__proto__&layout=9&region=-1,0,99999,2&mask=7&ev=1e9&divider=&class=constructor&x=Infinity", "#zoom=%&at=1,2,3&region=1&light=%00"]) {
    let alerted = false;
    page.once("dialog", (dialog) => { alerted = true; dialog.dismiss(); });
    await section.open(folder);
    await section.values();
    const plain = await look();
    await section.open(folder, hostile);
    await section.values();
    check(`a hostile address does nothing: ${hostile}`, !alerted && await page.locator("#compare img[src$='/x'], #compare script").count() === 0);
    check(`and chooses nothing: ${hostile}`, await look() === plain, [plain, await look()]);
    page.removeAllListeners("dialog");
  }
}

async function checkNarrow(section, folder, v, context) {
  const { page } = section, { who, light } = worst(v);
  await section.open(folder);
  await section.values();
  await section.set("left-who", who);
  await section.set("compare-light", light);
  check("the page is no wider than the window", await section.overflow() <= 0);
  const p = { x: Math.floor(v.width / 3), y: Math.floor(v.height / 2) };
  await page.locator("#compare .stage").scrollIntoViewIfNeeded();
  const at = await section.place(p.x, p.y);
  await page.touchscreen.tap(at.x, at.y);
  await section.settle();
  const seen = await section.pixel();
  check("a tap shows values", seen && Math.abs(seen.x - p.x) <= 1 && Math.abs(seen.y - p.y) <= 1, seen);
  if (seen) await checkPixel(section, v, light, seen);

  const session = await context.newCDPSession(page), middle = await section.place(v.width / 2, v.height / 2);
  const touch = (type, apart) => session.send("Input.dispatchTouchEvent", { type, touchPoints: apart ? [-1, 1].map((side, id) => ({ x: middle.x + side * apart, y: middle.y, id })) : [] });
  await touch("touchStart", 20);
  for (let k = 1; k <= 8; ++k) await touch("touchMove", 20 + 10 * k);
  await touch("touchEnd");
  await section.settle();
  const zoom = Number.parseFloat(await section.text("zoom-now")), fit = await page.evaluate(() => document.querySelector("#compare .half").clientWidth) / v.width;
  check("two fingers zoom", Math.abs(zoom / fit / 5 - 1) < 0.15, [zoom, fit]);
  await page.locator("#zoom-fit").click();
  for (const [layout, n] of [["2", 2], ["4", 4]]) {
    await section.set("compare-layout", layout);
    await section.settle();
    const tops = await page.locator("#compare .half").evaluateAll((halves) => halves.map((h) => h.getBoundingClientRect()).map((b) => [b.left, b.top]));
    check(`layout ${layout} stacks its panes`, new Set(tops.map(([left]) => left)).size === 1 && new Set(tops.map(([, top]) => top)).size === n, tops);
    check(`layout ${layout} is no wider than the window`, await section.overflow() <= 0);
    await section.accessible(`layout ${layout}`);
  }
  await section.set("compare-layout", "slider");
  await section.accessible("the narrow slider");
}

for (const scene of scenes) {
  const folder = join(report, scene), v = readValues(join(folder, "values.js"));
  for (const [width, height, touch] of [[1366, 768, false], [390, 844, true]]) {
    where = `${scene} ${width}x${height}`;
    const context = await browser.newContext({ viewport: { width, height }, hasTouch: touch, isMobile: touch }), page = await context.newPage();
    page.on("pageerror", (error) => check(error.stack, false));
    page.on("console", (message) => { if (message.type() === "error") check(message.text(), false); });
    await (touch ? checkNarrow : checkWide)(new Section(page), folder, v, context);
    await context.close();
  }
}

// Without values.js everything else works.
where = `${basename(scenes[0])} without values.js`;
const copy = mkdtempSync(join(tmpdir(), "umbra-compare-"));
cpSync(join(report, scenes[0]), join(copy, scenes[0]), { recursive: true, filter: (file) => !/\.(exr|json)$|values\.js$/.test(file) });
for (const file of readdirSync(report)) if (/\.(js|css)$/.test(file)) cpSync(join(report, file), join(copy, file));
const page = await browser.newPage({ viewport: { width: 1366, height: 768 } }), section = new Section(page);
page.on("pageerror", (error) => check(error.stack, false));
await section.open(join(copy, scenes[0]), "#mask=0.1&at=3,4&region=1,1,5,5");
await section.press("n", "f", "Shift+ArrowRight", "Digit2", "+", "e");
await section.settle();
check("it says so", await page.locator("#no-values").isVisible() && await page.locator("#values").isHidden());
check("the crosshair, the zoom and the exposure work", await section.text("pixel") === "Pixel 4, 4." && await section.text("zoom-now") !== "fit" && await section.text("exposure") === "+0.5 EV", await section.text("pixel"));
await section.accessible("a page without values");
rmSync(copy, { recursive: true });

await browser.close();
console.log(failed ? `${failed} of ${done} checks failed` : `the pictures of ${scenes.length} scenes compare: ${done} checks`);
process.exit(failed ? 1 : 0);
