// The page of `umbra view`: it sends the state of the scene and draws the answer. One request is under way at a time,
// and the next one has the newest state, so that nothing is queued up.
"use strict";

const $ = (id) => document.getElementById(id);
const add = (a, b, s = 1) => a.map((x, i) => x + s * b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const size = (a) => Math.hypot(...a);
const scaled = (a, s) => a.map((x) => x * s);
const unit = (a) => scaled(a, 1 / (size(a) || 1));
const withAttributes = (e, attributes) => {
  for (const [key, value] of Object.entries(attributes)) e.setAttribute(key, value);
  return e;
};
const element = (name, attributes = {}, text = "") => {
  const e = withAttributes(document.createElement(name), attributes);
  if (text) e.textContent = text;
  return e;
};
const shape = (name, attributes) => withAttributes(document.createElementNS("http://www.w3.org/2000/svg", name), attributes);
/** An item of a list, behind a patch of the colour. */
const swatched = (colour, text) => {
  const item = element("li"), swatch = element("span", { class: "swatch" });
  swatch.style.background = colour;
  item.append(swatch, text);
  return item;
};
const figure = (x) => (x === null || x === undefined ? "–" : x === 0 ? "0" : x >= 100 ? x.toFixed(0) : x >= 0.01 ? x.toPrecision(3) : x.toExponential(1));

const pageName = Math.random().toString(36).slice(2);
let scene, home, state, last = null, why = null;

/** Rotates v about a unit axis. [Olinde Rodrigues, 1840] */
function turned(v, axis, angle) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return add(add(scaled(v, c), cross(axis, v), s), axis, dot(axis, v) * (1 - c));
}

// ---- the camera, as core/scene/camera.h has it

function view() {
  const forward = unit(add(state.target, state.eye, -1));
  const right = unit(cross(forward, scene.up)), up = cross(right, forward);
  const [w, h] = state.size;
  return { forward, right, up, half_height: scene.half_height, half_width: scene.half_height * w / h };
}
/** Pixels of the whole picture, and the depth. */
function project(p) {
  const v = view(), d = add(p, state.eye, -1), depth = dot(d, v.forward), z = scene.orthographic ? 1 : depth;
  const [w, h] = state.size;
  return { x: (dot(d, v.right) / (z * v.half_width) + 1) / 2 * w, y: (1 - dot(d, v.up) / (z * v.half_height)) / 2 * h, depth };
}
/** The position of a pixel at a depth. */
function position(x, y, depth) {
  const v = view(), [w, h] = state.size, z = scene.orthographic ? 1 : depth;
  const across = (2 * x / w - 1) * v.half_width * z, along = (1 - 2 * y / h) * v.half_height * z;
  return add(add(add(state.eye, v.forward, depth), v.right, across), v.up, along);
}
const extent = () => size(add(scene.high, scene.low, -1)) || 1;
const middle = () => scaled(add(scene.high, scene.low), 0.5);

// ---- the state

function startState() {
  return {
    eye: [...scene.eye], target: [...scene.target], lights: {}, objects: {}, methods: [...scene.chosen],
    second: scene.chosen.length > 1 ? "method" : "truth", light: 0, layer: "visibility", frame: 0,
    size: [scene.width, scene.height],
  };
}
function lightNow(j) {
  const l = scene.lights[j];
  return state.lights[j] || { position: l.position, direction: l.direction, size: 1 };
}
function placeLight(j, change) {
  state.lights[j] = { ...lightNow(j), ...change };
  changed();
}
function objectNow(o) { return state.objects[o] || { move: [0, 0, 0], turn: 0 }; }
function placeObject(o, change) {
  state.objects[o] = { ...objectNow(o), ...change };
  changed();
}

/** Where a light's handle is: of a light at infinity, on the way from it to the middle of the scene. */
function handleOf(j) {
  const l = lightNow(j);
  return scene.lights[j].kind === "directional" ? add(middle(), unit(l.direction), -0.45 * extent()) : l.position;
}
const turns = (j) => ["spot", "disk", "rectangle"].includes(scene.lights[j].kind);
const aimOf = (j) => add(lightNow(j).position, unit(lightNow(j).direction), 0.12 * extent());

// ---- requests

let busy = false, dirty = true, truthWanted = 0, restTimer = 0, quarter = 1, long = 0;
const recent = [];

function body(truth, width, height) {
  const placed = (all, name) => Object.entries(all).map(([k, v]) => ({ [name]: Number(k), ...v }));
  return {
    page: pageName, width, height, frame: state.frame, eye: state.eye, target: state.target,
    lights: placed(state.lights, "light"), objects: placed(state.objects, "object"),
    methods: state.second === "method" ? state.methods.slice(0, 2) : state.methods.slice(0, 1),
    light: state.light, layer: state.layer, truth,
  };
}
async function post(name, what) {
  const response = await fetch(name, { method: "POST", body: JSON.stringify(what), headers: { "Content-Type": "application/json" } });
  if (!response.ok) throw new Error((await response.text()).trim());
  return response;
}

/** The state is another one: a picture now, the truth when it rests. */
function changed() {
  dirty = true;
  truthWanted = 0;
  why = null;
  $("why").hidden = true;
  clearTimeout(restTimer);
  restTimer = setTimeout(() => { truthWanted = 1; dirty = dirty || quarter > 1; quarter = 1; long = 0; pump(); }, 250);
  drawHandles();
  pump();
}

async function pump() {
  if (busy) return;
  const truth = dirty ? 0 : truthWanted;
  if (!dirty && !truth) return;
  busy = true;
  dirty = false;
  if (truth) truthWanted = 0;
  const part = truth ? 1 : quarter;
  const [w, h] = state.size.map((n) => Math.max(16, Math.round(n / part)));
  try {
    const began = performance.now();
    const buffer = await (await post("show", body(truth, w, h))).arrayBuffer();
    const length = new DataView(buffer).getUint32(0, true);
    last = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    drawPictures(new Uint8Array(buffer, 4 + length));
    const ms = performance.now() - began;
    document.body.dataset.frames = Number(document.body.dataset.frames || 0) + 1;
    document.body.dataset.ms = ms.toFixed(1);
    if (!truth) {
      recent.push(ms);
      // A quarter of the size where whole pictures stall the hand, until it rests.
      long = part === 1 && ms > 100 ? long + 1 : 0;
      if (long > 1) quarter = 4;
    }
    if (truth === 1 && last.truth && !last.truth.failed && last.truth.judged < last.truth.of && !dirty) truthWanted = 2;
    $("message").textContent = "";
    drawFigures();
  } catch (error) {
    $("message").textContent = error.message;
    if (/still being answered/.test(error.message)) setTimeout(() => { dirty = true; pump(); }, 200);
  }
  busy = false;
  if (dirty || truthWanted) pump();
}

// ---- drawing

function drawPictures(bytes) {
  const { width, height } = last, pixels = width * height;
  const canvases = [$("left"), $("right")];
  const shown = Math.floor(bytes.length / (3 * pixels));
  canvases.forEach((canvas, k) => {
    canvas.hidden = k >= shown;
    if (k >= shown) return;
    canvas.width = width;
    canvas.height = height;
    const image = new ImageData(width, height), to = image.data;
    for (let i = 0, at = 3 * k * pixels; i < pixels; ++i) {
      to[4 * i] = bytes[at++];
      to[4 * i + 1] = bytes[at++];
      to[4 * i + 2] = bytes[at++];
      to[4 * i + 3] = 255;
    }
    canvas.getContext("2d").putImageData(image, 0, 0);
  });
  divide();
  const names = last.sides.map((s) => s.method + (s.failed ? ": " + s.failed : s.phases.length ? "" : ": does not serve this scene: " + s.serves.why));
  if (names.length < 2 && shown > 1) names.push(`the truth: ${last.truth.method}`);
  $("sides").textContent = names.length > 1 ? `Left ${names[0]}; right ${names[1]}` : names[0];
}
function divide() {
  const at = $("right").hidden ? 100 : Number($("divider").value);
  $("right").style.clipPath = `inset(0 0 0 ${at}%)`;
  $("bar").hidden = $("right").hidden;
  $("bar").style.left = at + "%";
}

function handle(kind, p, label, move) {
  const at = project(p);
  if (at.depth <= 0 && !scene.orthographic) return;
  const [w, h] = state.size;
  const r = 7 * w / ($("stage").clientWidth || w);
  const x = Math.min(Math.max(at.x, r), w - r), y = Math.min(Math.max(at.y, r), h - r);  // in reach, where it is outside
  const circle = shape("circle", { cx: x, cy: y, r: kind === "aim" ? 0.7 * r : r, class: "handle " + kind, tabindex: 0, role: "button", "aria-label": label });
  circle.dataset.key = kind + label;
  circle.addEventListener("pointerdown", (event) => {
    event.stopPropagation();
    event.preventDefault();
    const grab = project(p), from = [event.clientX, event.clientY], scale = w / $("stage").clientWidth;
    drag(event, (e) => move(position(grab.x + (e.clientX - from[0]) * scale, grab.y + (e.clientY - from[1]) * scale, grab.depth)));
  });
  circle.addEventListener("keydown", (event) => {
    const step = w / 50, deep = extent() / 50;
    const way = { ArrowLeft: [-step, 0, 0], ArrowRight: [step, 0, 0], ArrowUp: [0, -step, 0], ArrowDown: [0, step, 0], PageUp: [0, 0, deep], PageDown: [0, 0, -deep] }[event.key];
    if (!way) return;
    event.preventDefault();
    event.stopPropagation();
    const here = project(p), [dx, dy, dz] = way;
    move(add(position(here.x + dx, here.y + dy, here.depth), view().forward, dz));
  });
  $("over").append(circle);
}

function drawHandles() {
  const over = $("over"), focused = document.activeElement && document.activeElement.dataset ? document.activeElement.dataset.key : undefined;
  over.replaceChildren();
  over.setAttribute("viewBox", `0 0 ${state.size[0]} ${state.size[1]}`);
  over.setAttribute("preserveAspectRatio", "none");
  drawWhy();
  scene.lights.forEach((l, j) => {
    const sun = l.kind === "directional";
    handle("light", handleOf(j), `light ${l.name}: arrow keys move it, Page Up and Page Down along the view`,
      (p) => placeLight(j, sun ? { direction: unit(add(middle(), p, -1)) } : { position: p }));
    if (turns(j)) handle("aim", aimOf(j), `where light ${l.name} points`, (p) => placeLight(j, { direction: unit(add(p, lightNow(j).position, -1)) }));
  });
  const o = $("object").value;
  if (o !== "") {
    const start = scene.objects[o].middle;
    handle("object", add(start, objectNow(o).move), `object ${scene.objects[o].name}`, (p) => placeObject(o, { move: add(p, start, -1) }));
  }
  if (focused) for (const e of over.children) if (e.dataset.key === focused) e.focus();
}

function drawWhy() {
  if (!why) return;
  const points = (all) => all.map(project).filter((p) => p.depth > 0 || scene.orthographic).map((p) => `${p.x},${p.y}`).join(" ");
  const from = project(why.position);
  for (const a of why.answers) {
    if (a.blocker_corners.length) $("over").append(shape("polygon", { class: "blocker", points: points(a.blocker_corners) }));
    if (a.texel) $("over").append(shape("polygon", { class: "texel", points: points(a.texel) }));
    for (const edge of a.silhouette || []) $("over").append(shape("polyline", { class: "edge", points: points([edge.slice(0, 3), edge.slice(3)]) }));
    if (a.towards) $("over").append(shape("polyline", { class: "ray", points: points([why.position, a.towards]), fill: "none" }));
  }
  $("over").append(shape("circle", { class: "asked", cx: from.x, cy: from.y, r: 5 * state.size[0] / $("stage").clientWidth }));
}

function drawFigures() {
  const phases = ["build", "aim", "look", "visibility"];
  const table = element("table", { class: "phases" });
  const head = element("tr");
  for (const name of ["ms", ...phases, "MB"]) head.append(element("th", { scope: "col" }, name));
  table.append(head);
  for (const side of last.sides) {
    const row = element("tr");
    row.append(element("th", { scope: "row" }, side.method.split(":")[0]));
    for (const name of phases) {
      const phase = side.phases.find((p) => p.phase === name);
      const cell = element("td", phase && phase.repeated ? { class: "lit", "data-phase": name } : { "data-phase": name }, phase ? (phase.repeated ? figure(phase.ms) : "kept") : "–");
      row.append(cell);
    }
    row.append(element("td", {}, figure(side.memory_bytes / 1e6)));
    table.append(row);
  }
  $("times").replaceChildren(table);
  $("shared").textContent = `Shared by all methods: facts ${figure(last.facts_ms)} ms, surface points ${figure(last.points_ms)} ms, pictures ${figure(last.pictures_ms)} ms.`;
  const few = recent.slice(-60), most = Math.max(...few, 1);
  $("spark").replaceChildren(shape("path", { d: few.map((ms, k) => `${k ? "L" : "M"}${4 * k} ${38 - 36 * ms / most}`).join("") }));
  $("spark-text").textContent = few.length ? `The last frame took ${figure(few[few.length - 1])} ms from the request to the picture; the longest of the last ${few.length}, ${figure(most)} ms.` : "";

  const errors = $("errors");
  errors.replaceChildren();
  const truth = last.truth;
  errors.append(element("p", { class: "small" }, !truth ? "The truth is computed when the picture rests." : truth.failed ||
    `The truth: ${truth.method}${truth.exact ? "" : ", which is not exact"}, in ${figure(truth.ms)} ms` +
      (truth.judged < truth.of ? `; at a sample of ${truth.judged} of ${truth.of} points` : `; at all ${truth.of} points`)));
  for (const side of last.sides) {
    if (!side.errors) continue;
    const e = side.errors;
    errors.append(element("p", {}, `${side.method}: ${e.wrong_interior} wrong interior points of ${e.points}, RMSE ${figure(e.rmse)}` + (e.flip === null ? "" : `, mean FLIP ${figure(e.flip)}`) +
      (e.undefined ? `, ${e.undefined} undefined` : "") + (e.on_boundary ? `, ${e.on_boundary} on the boundary` : "")));
    const list = element("ul", { class: "small" });
    for (const c of e.classes) list.append(swatched(c.colour, `${c.name}: ${c.points}`));
    if (e.classes.length) errors.append(list);
  }
  if (state.layer !== "picture" && state.layer !== "visibility" && last.sides.some((s) => s.layer !== state.layer))
    $("scales").textContent = "Until the truth is there, S is shown.";
  else
    $("scales").textContent = { visibility: "S: white is lit, black is umbra; dark blue: no surface.", picture: "", difference: "Blue: too dark. Red: too bright.", classes: "Grey: right. Colours as in the list of classes.", flip: "Black: no difference that the eye sees in the final pictures; light yellow: the greatest." }[state.layer];
}

// ---- the hand

function drag(event, moved, done = () => {}) {
  const stage = $("stage");
  stage.setPointerCapture(event.pointerId);
  const move = (e) => { if (e.pointerId === event.pointerId) moved(e); };
  const end = (e) => {
    if (e.pointerId !== event.pointerId) return;
    for (const [type, listener] of listeners) stage.removeEventListener(type, listener);
    done(e);
  };
  const listeners = [["pointermove", move], ["pointerup", end], ["pointercancel", end]];
  for (const [type, listener] of listeners) stage.addEventListener(type, listener);
}
function orbit(dx, dy) {
  const arm = add(state.eye, state.target, -1), up = unit(scene.up);
  const yawed = turned(arm, up, -dx), side = unit(cross(up, yawed));
  const pitched = turned(yawed, side, -dy);
  state.eye = add(state.target, Math.abs(dot(unit(pitched), up)) < 0.999 ? pitched : yawed);
  changed();
}
function zoom(factor) {
  state.eye = add(state.target, scaled(add(state.eye, state.target, -1), factor));
  changed();
}
function pan(dx, dy) {
  const v = view(), reach = scene.orthographic ? 1 : size(add(state.eye, state.target, -1));
  const by = add(scaled(v.right, -2 * dx * v.half_width * reach), v.up, 2 * dy * v.half_height * reach);
  state.eye = add(state.eye, by);
  state.target = add(state.target, by);
  changed();
}

function listen() {
  const stage = $("stage"), fingers = new Map();
  stage.addEventListener("pointerdown", (event) => {
    stage.focus({ preventScroll: true });
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    let far = 0;
    drag(event, (e) => {
      const [x, y] = fingers.get(e.pointerId), dx = (e.clientX - x) / stage.clientWidth, dy = (e.clientY - y) / stage.clientHeight;
      if (fingers.size === 2) {
        const [a, b] = [...fingers.values()], before = Math.hypot(a[0] - b[0], a[1] - b[1]);
        fingers.set(e.pointerId, [e.clientX, e.clientY]);
        const [c, d] = [...fingers.values()];
        zoom(before / Math.max(1, Math.hypot(c[0] - d[0], c[1] - d[1])));
        far = 1;
        return;
      }
      far += Math.abs(dx) + Math.abs(dy);
      fingers.set(e.pointerId, [e.clientX, e.clientY]);
      if (far < 0.004) return;
      if (e.shiftKey || e.buttons & 6) pan(dx, dy); else orbit(3 * dx, 3 * dy);
    }, (e) => {
      fingers.delete(e.pointerId);
      if (far < 0.004 && e.type === "pointerup") askWhy(e.clientX, e.clientY);
    });
  });
  stage.addEventListener("contextmenu", (event) => event.preventDefault());
  stage.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(Math.max(-1, Math.min(1, event.deltaY / 400))));
  }, { passive: false });
  stage.addEventListener("keydown", (event) => {
    if (event.target !== stage) return;
    const a = 0.06, keys = {
      ArrowLeft: () => (event.shiftKey ? pan(0.05, 0) : orbit(a, 0)), ArrowRight: () => (event.shiftKey ? pan(-0.05, 0) : orbit(-a, 0)),
      ArrowUp: () => (event.shiftKey ? pan(0, 0.05) : orbit(0, a)), ArrowDown: () => (event.shiftKey ? pan(0, -0.05) : orbit(0, -a)),
      "+": () => zoom(0.9), "=": () => zoom(0.9), "-": () => zoom(1 / 0.9),
      Enter: () => { const r = stage.getBoundingClientRect(); askWhy(r.left + r.width / 2, r.top + r.height / 2); },
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
  $("divider").addEventListener("input", divide);
  $("layer").addEventListener("change", () => { state.layer = $("layer").value; changed(); });
  $("light").addEventListener("change", () => { state.light = Number($("light").value); showControls(); changed(); });
  $("second").addEventListener("change", () => {
    state.second = $("second").value;
    if (state.second === "method" && state.methods.length < 2) state.methods.push(scene.methods.find((m) => m.by_default && m.name !== state.methods[0].split(":")[0]).name);
    showMethods();
    changed();
  });
  $("size").addEventListener("change", () => { state.size = $("size").value.split("x").map(Number); fit(); changed(); });
  $("object").addEventListener("change", () => { showControls(); drawHandles(); });
  $("turn").addEventListener("input", () => placeObject($("object").value, { turn: Number($("turn").value) }));
  $("extent").addEventListener("input", () => placeLight(state.light, { size: 2 ** Number($("extent").value) }));
  $("reset").addEventListener("click", () => {
    state.lights = {}, state.objects = {}, state.eye = [...scene.eye], state.target = [...scene.target];
    showControls();
    changed();
  });
  $("frame").addEventListener("input", () => { state.frame = Number($("frame").value); changed(); });
  $("play").addEventListener("click", play);
  $("copy-command").addEventListener("click", () => copy(commandNow(), "The command"));
  $("copy-address").addEventListener("click", () => { location.hash = encoded(); copy(location.href, "The address"); });
  $("save").addEventListener("click", save);
  addEventListener("resize", drawHandles);
}

let playing = 0;
function play() {
  clearInterval(playing);
  playing = playing ? 0 : setInterval(() => {
    if (busy) return;
    state.frame = (state.frame + 1) % scene.frames;
    $("frame").value = state.frame;
    changed();
  }, 100);
  $("play").textContent = playing ? "Stop" : "Play";
}

async function askWhy(clientX, clientY) {
  const box = $("stage").getBoundingClientRect(), [w, h] = state.size;
  const x = Math.floor((clientX - box.left) / box.width * w), y = Math.floor((clientY - box.top) / box.height * h);
  try {
    while (busy) await new Promise((resolve) => setTimeout(resolve, 20));
    busy = true;
    why = await (await post("why", { ...body(0, w, h), x, y })).json();
  } catch (error) {
    why = null;
    $("message").textContent = error.message;
  }
  busy = false;
  $("why").hidden = !why;
  if (why) {
    const list = element("dl");
    for (const a of why.answers) {
      list.append(element("dt", {}, a.method), element("dd", {}, a.sentence));
      if (a.difference) list.append(element("dd", { class: "unlike" }, `Unlike the truth: ${a.difference}`));
    }
    $("why-text").replaceChildren(element("p", {}, `Pixel ${x}, ${y}: triangle ${why.triangle} of ${why.object}, light ${why.light}.`),
      why.decided ? element("p", {}, why.decided) : list);
    if (why.seen) drawSeen(why.seen, why.answers.find((a) => a.samples));
  }
  drawHandles();
  pump();
}

/** What the point sees of the light, and the samples that a method took of it. */
function drawSeen(seen, sampled) {
  const n = seen.side, canvas = element("canvas", { id: "seen", width: n, height: n, role: "img", "aria-label": "The light as this point sees it" });
  canvas.style.aspectRatio = seen.aspect;
  const draw = canvas.getContext("2d"), blockers = new Map();
  const hue = (o) => `hsl(${(o * 137.5 + 20) % 360} 45% 42%)`;
  seen.cells.forEach((cell, k) => {
    if (cell === -2) return;
    draw.fillStyle = cell === -1 ? "#ffe9a0" : cell === -3 ? "#55555c" : hue(cell);
    draw.fillRect(k % n, Math.floor(k / n), 1, 1);
    if (cell >= 0) blockers.set(cell, (blockers.get(cell) || 0) + 1);
  });
  const on = seen.cells.filter((c) => c !== -2).length, list = element("ul", { class: "small" });
  const row = (colour, text) => list.append(swatched(colour, text));
  row("#ffe9a0", `seen: ${(100 * seen.fraction).toFixed(1)} % of ${on} places on the light, by rays`);
  for (const [o, count] of blockers) row(hue(o), `behind ${scene.objects[o].name}: ${(100 * count / on).toFixed(1)} %`);
  if (seen.cells.includes(-3)) row("#55555c", "behind the plane of the point");
  const light = element("div", { class: "seen" });
  light.append(canvas);
  if (sampled) {
    const [middle, right, up] = seen.frame, dots = shape("svg", { viewBox: "-1 -1 2 2", preserveAspectRatio: "none", "aria-hidden": "true" });
    for (const [x, y, z, hit] of sampled.samples) {
      const at = add([x, y, z], middle, -1), along = (axis) => dot(at, axis) / dot(axis, axis);
      dots.append(shape("ellipse", { class: hit ? "hit" : "missed", cx: along(right), cy: -along(up), rx: 0.03 / Math.max(seen.aspect, 1), ry: 0.03 * Math.min(seen.aspect, 1) }));
    }
    light.append(dots);
    row("#0b6", `samples of ${sampled.method} that see the light: ${sampled.samples.filter((s) => s[3]).length}`);
    row("#d22", `samples that do not: ${sampled.samples.filter((s) => !s[3]).length}`);
  }
  $("why-text").append(element("h3", {}, "What the point sees of the light"), light, list);
}

// ---- controls

/** NAME:k=v,... as the name and its settings; presets stand for theirs. */
function parsed(text) {
  const [head, settings = ""] = text.split(/:(.*)/s), [name, preset] = head.split("@");
  const info = scene.methods.find((m) => m.name === name), values = {};
  const read = (list) => list.split(",").filter(Boolean).forEach((pair) => { const [key, value] = pair.split(/=(.*)/s); values[key] = value; });
  if (preset) read((info.presets.find((p) => p.name === preset) || { settings: "" }).settings);
  read(settings);
  return { info, values };
}
function setMethod(k, info, values) {
  const settings = Object.entries(values).filter(([key, value]) => String(info.parameters.find((p) => p.name === key).default) !== String(value));
  state.methods[k] = info.name + (settings.length ? ":" + settings.map(([key, value]) => `${key}=${value}`).join(",") : "");
  changed();
}

function showMethods() {
  $("methods").replaceChildren();
  const shown = state.second === "method" ? 2 : 1;
  for (let k = 0; k < shown; ++k) {
    const { info, values } = parsed(state.methods[k]);
    const field = element("fieldset", { class: "method" });
    field.append(element("legend", {}, shown > 1 ? (k ? "Right: method" : "Left: method") : "Method"));
    const choose = element("select", { "aria-label": "Method" });
    for (const m of scene.methods) choose.append(new Option(m.title, m.name, false, m.name === info.name));
    choose.addEventListener("change", () => { setMethod(k, scene.methods.find((m) => m.name === choose.value), {}); showMethods(); });
    field.append(choose);
    if (info.presets.length) {
      const label = element("label", {}, "Preset "), presets = element("select");
      presets.append(new Option("–", ""));
      for (const p of info.presets) presets.append(new Option(`${p.name}: ${p.doc}`, p.name));
      presets.addEventListener("change", () => { setMethod(k, info, parsed(`${info.name}${presets.value ? "@" + presets.value : ""}`).values); showMethods(); });
      label.append(presets);
      field.append(label);
    }
    const details = element("details");
    details.open = info.parameters.length < 8;
    details.append(element("summary", {}, `${info.parameters.length} parameters`));
    for (const p of info.parameters) details.append(parameterControl(k, info, values, p));
    if (info.parameters.length) field.append(details);
    $("methods").append(field);
  }
}

function parameterControl(k, info, values, p) {
  const now = values[p.name] ?? p.default, label = element("label", {}, p.name.replaceAll("_", " ") + (p.unit ? `, ${p.unit}` : "") + " ");
  let input;
  if (p.type === "choice") {
    input = element("select");
    for (const word of p.choices.split("|")) input.append(new Option(word, word, false, String(now) === word));
  } else if (p.type === "boolean") {
    input = element("input", { type: "checkbox" });
    input.checked = String(now) === "true";
  } else {
    input = element("input", p.type === "text" ? { type: "text" } : { type: "number", min: p.min, max: p.max, step: p.type === "integer" ? 1 : "any" });
    input.value = now;
  }
  input.addEventListener(p.type === "real" || p.type === "integer" ? "input" : "change", () => {
    if (!input.checkValidity() || input.value === "") { $("message").textContent = `${p.name}: expected ${p.min} to ${p.max}`; return; }
    setMethod(k, info, { ...parsed(state.methods[k]).values, [p.name]: p.type === "boolean" ? input.checked : input.value });
  });
  label.append(input, element("span", { class: "doc" }, p.doc));
  return label;
}

function showControls() {
  const l = scene.lights[state.light], o = $("object").value;
  $("sizing").hidden = !l || !(l.extent > 0);
  $("extent").value = Math.log2(scene.lights.length ? lightNow(state.light).size : 1);
  $("turning").hidden = o === "";
  if (o !== "") $("turn").value = objectNow(o).turn;
  $("layer").value = state.layer;
  $("light").value = state.light;
  $("second").value = state.second;
  $("frame").value = state.frame;
}
function fit() {
  $("stage").style.setProperty("--w", state.size[0]);
  $("stage").style.setProperty("--h", state.size[1]);
}

// ---- to take away

const isMoved = () => Object.keys(state.lights).length > 0 || Object.keys(state.objects).length > 0 || String(state.eye) !== String(scene.eye) || String(state.target) !== String(scene.target);
function commandNow() {
  const methods = (state.second === "method" ? state.methods : state.methods.slice(0, 1)).join(" ");
  const file = isMoved() ? `${scene.name}_now.json` : scene.command.split(" ")[2] + (state.frame ? "@" + state.frame : "");
  return `umbra compare ${file} --methods ${methods} --size ${state.size.join("x")} -o results`;
}
function encoded() { return btoa(unescape(encodeURIComponent(JSON.stringify(state)))).replaceAll("+", "-").replaceAll("/", "_"); }
function decoded(text) {
  try {
    return { ...startState(), ...JSON.parse(decodeURIComponent(escape(atob(text.replaceAll("-", "+").replaceAll("_", "/"))))) };
  } catch {
    return startState();
  }
}
async function copy(text, what) {
  try {
    await navigator.clipboard.writeText(text);
    $("taken").textContent = `${what} is copied: ${text}` + (isMoved() && what === "The command" ? " (save the scene first)" : "");
  } catch {
    $("taken").textContent = text;
  }
}
async function save() {
  try {
    while (busy) await new Promise((resolve) => setTimeout(resolve, 20));
    busy = true;
    const blob = await (await post("file", body(0, ...state.size))).blob();
    const link = element("a", { href: URL.createObjectURL(blob), download: `${scene.name}_now.json` });
    link.click();
    $("taken").textContent = `${link.download} is saved.`;
  } catch (error) {
    $("taken").textContent = error.message;
  }
  busy = false;
  pump();
}

async function begin() {
  scene = await (await fetch("scene.json")).json();
  state = location.hash.length > 1 ? decoded(location.hash.slice(1)) : startState();
  $("title").textContent = scene.title;
  scene.lights.forEach((l, j) => $("light").append(new Option(`${l.name} (${l.kind})`, j)));
  $("object").append(new Option("none", ""));
  scene.objects.forEach((o, k) => { if (o.movable) $("object").append(new Option(o.name, k)); });
  for (const part of [0.5, 1, 1.5, 2]) {
    const [w, h] = [scene.width, scene.height].map((n) => Math.max(16, Math.round(n * part)));
    if (w <= 1920 && h <= 1920 && w * h <= 1 << 20) $("size").append(new Option(`${w} × ${h}`, `${w}x${h}`, part === 1, part === 1));
  }
  if (!$("size").options.length) {
    const shrink = Math.sqrt((1 << 20) / (scene.width * scene.height)) * 0.9;
    $("size").append(new Option("fitted", [scene.width, scene.height].map((n) => Math.floor(n * shrink)).join("x")));
  }
  if (![...$("size").options].some((o) => o.value === state.size.join("x"))) state.size = $("size").options[$("size").options.length - 1].value.split("x").map(Number);
  $("size").value = state.size.join("x");
  if (scene.frames > 1) {
    $("frames").hidden = false;
    $("frame").max = scene.frames - 1;
  }
  fit();
  showMethods();
  showControls();
  listen();
  changed();
}
begin().catch((error) => { $("message").textContent = error.message; });
