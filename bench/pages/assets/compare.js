// The section "Compare pictures" of a scene's page: any two or four of its figures side by side, and the values behind
// them. A page from disk may not read its own pictures back, so that the values come as a script, values.js, which is
// loaded when somebody first turns to the section. Without it everything works that needs no values.
"use strict";

/** Names as the legend writes them, and short ones for the inside of a pixel. From `kWrong` on, points are wrong. */
const kClasses = {
  no_surface: ["no surface", "–"], away: ["facing away", "away"], terminator_away: ["facing away, at the terminator", "away"],
  not_judged: ["not in the sample", "not"], undefined: ["undefined", "open"], on_boundary: ["on the boundary: never wrong", "bound"],
  right: ["right", "right"], terminator: ["right, at the terminator", "right t"], terminator_wrong: ["wrong at the terminator", "term"],
  false_shadow_edge: ["false shadow: edge band", "s edge"], false_shadow: ["false shadow: other", "shadow"], acne: ["false shadow: acne", "acne"],
  false_light_edge: ["false light: edge band", "l edge"], false_light: ["false light: unknown occluder", "light"],
  detachment: ["false light: detachment", "detach"], leak: ["false light: leak", "leak"], penumbra: ["penumbra", "penum"], noise: ["noise", "noise"],
  unshadowed: ["unshadowed", "lit"],
};
const kRight = 6, kWrong = 8, kUnshadowed = 18, kAnswered = 0x8000;
const sOf = (value) => value & 255, classOf = (value) => value >> 8 & 127;
const isWrong = (c) => c >= kWrong && c < kUnshadowed;
const signed = (d, digits) => Number(d.toFixed(digits)) === 0 ? (0).toFixed(digits) : (d < 0 ? "−" : "+") + Math.abs(d).toFixed(digits);

/** What values.js holds. A plane is decoded when it is first asked for; until then it is null, and `ready` tells. */
class Values {
  constructor(data, ready) {
    Object.assign(this, data);
    this.ready = ready;
    this.decoded = new Map();
  }
  decode(url, Plane, pack) {
    if (!url || this.decoded.has(url)) return this.decoded.get(url) || null;
    this.decoded.set(url, null);
    const image = new Image();
    image.addEventListener("load", () => {
      const canvas = Object.assign(document.createElement("canvas"), { width: this.width, height: this.height });
      const context = canvas.getContext("2d", { willReadFrequently: true });
      context.drawImage(image, 0, 0);
      const rgb = context.getImageData(0, 0, this.width, this.height).data, plane = new Plane(this.width * this.height);
      for (let i = 0; i < plane.length; ++i) plane[i] = pack(rgb[4 * i], rgb[4 * i + 1], rgb[4 * i + 2]);
      this.decoded.set(url, plane);
      this.ready();
    });
    image.src = url;
    return null;
  }
  plane(who, light) {
    const column = this.columns.find((c) => c.who === who);
    return column ? this.decode(column.planes[this.lights.indexOf(light)], Uint16Array, (r, g, b) => r | g << 8 | (b && kAnswered)) : null;
  }
  /** What the method was compared with: methods of another measure have a truth of their own. */
  truth(who, light) {
    const column = this.columns.find((c) => c.who === who);
    return this.plane((column && column.truth) || "Reference", light);
  }
  /** The object at a point, in words. */
  surface(i) {
    const faces = this.decode(this.faces, Uint32Array, (r, g, b) => r << 16 | g << 8 | b);
    if (!faces) return "";
    if (!faces[i]) return "no surface";
    let triangle = faces[i] - 1;
    for (const [name, triangles] of this.objects) {
      if (triangle < triangles) return `triangle ${triangle} of ${name}`;
      triangle -= triangles;
    }
    return "";
  }
  /** Calls `visit(index, difference * 255, class)` at the compared points of a rectangle. */
  compared(who, light, box, visit) {
    const a = this.plane(who, light), b = this.truth(who, light);
    if (!a || !b) return false;
    for (let y = box.y; y < box.y + box.h; ++y) {
      for (let i = y * this.width + box.x, end = i + box.w; i < end; ++i) {
        const c = classOf(a[i]);
        if (c >= kRight && c !== kUnshadowed && a[i] & b[i] & kAnswered) visit(i, sOf(a[i]) - sOf(b[i]), c);
      }
    }
    return true;
  }
  words(c, short = 0) { return (kClasses[this.classes[c]] || [])[short] || String(this.classes[c]).replaceAll("_", " "); }
}

class Compare {
  constructor(section) {
    this.section = section;
    this.$ = (id) => document.getElementById(id);
    const $ = this.$, figures = [...document.querySelectorAll("img[data-who]")];
    const rank = (what) => ["picture", "S of", "difference", "errors"].findIndex((start) => what.startsWith(start)) >>> 0;
    this.whos = [...new Set(figures.map((f) => f.dataset.who))];
    this.whats = [...new Set(figures.map((f) => f.dataset.what))].sort((a, b) => rank(a) - rank(b));
    this.find = (who, what) => figures.find((f) => f.dataset.who === who && f.dataset.what === what);
    this.lights = this.whats.filter((what) => what.startsWith("S of ")).map((what) => what.slice(5));
    this.at = this.seen = this.region = this.values = this.mask = null;  // `at`: the crosshair; `seen`: whose values are shown
    this.ev = 0;

    section.hidden = false;
    for (const link of document.querySelectorAll('a[href="#compare"]')) link.parentElement.hidden = false;
    this.panes = ["left", "right", "third", "fourth"].map((name) => ({ name, who: $(name + "-who"), what: $(name + "-what") }));
    this.slider = new Slider(section.querySelector(".slider"), {
      zoom: true,
      changed: (slider) => {
        $("zoom-now").textContent = slider.zoomed() ? `${Number(slider.zoom.toFixed(1))} ×` : "fit";
        $("zoom-out").disabled = !slider.zoomed();
        $("zoom-in").disabled = slider.zoom >= 64;
        this.refresh(false);
      },
      hover: (pixel) => this.look(pixel),
      click: (pixel) => this.aim(pixel),
      selects: (event) => event.altKey || this.selecting(),
      select: (from, to) => this.selectRegion(from, to),
      keys: (event) => this.key(event),
    });
    for (const name of this.lights) $("compare-light").add(new Option(name));
    for (const [i, pane] of this.panes.entries()) {
      for (const option of this.whos) pane.who.add(new Option(option));
      for (const option of this.whats) pane.what.add(new Option(option));
      const tag = section.querySelector(`.tag.${pane.name}`);  // the pair that the page was written with
      this.choose(pane, tag && this.whos.includes(tag.textContent) ? tag.textContent : this.whos[i % this.whos.length], this.whats[0]);
      for (const select of [pane.who, pane.what]) select.addEventListener("change", () => { pane.chosen = true; this.choose(pane, pane.who.value, pane.what.value); this.follow(pane); });
    }
    $("zoom-in").addEventListener("click", () => this.slider.zoomIn());
    $("zoom-out").addEventListener("click", () => this.slider.zoomOut());
    $("zoom-fit").addEventListener("click", () => this.slider.setZoom(0));
    $("compare-layout").addEventListener("change", () => this.arrange());
    $("compare-light").addEventListener("change", () => {
      for (const pane of this.panes) {  // what a light's picture shows is that light's
        const light = this.lightOf(pane.what.value);
        if (light !== null) this.choose(pane, pane.who.value, pane.what.value.slice(0, -light.length) + $("compare-light").value);
      }
      this.show();
    });
    for (const id of ["mask-on", "mask-least"]) $(id).addEventListener("input", () => { if (id === "mask-least") $("mask-on").checked = true; this.refresh(); });
    $("wrong-class").addEventListener("change", () => this.refresh());
    $("wrong-previous").addEventListener("click", () => this.jump(-1));
    $("wrong-next").addEventListener("click", () => this.jump(1));
    $("region-on").addEventListener("click", () => this.selecting(!this.selecting()));
    $("region-clear").addEventListener("click", () => this.clearRegion());
    $("copy-view").addEventListener("click", () => this.copyAddress());
    this.slider.stage.addEventListener("keyup", (event) => { if (event.key.toLowerCase() === "r") this.hold(false); });
    this.slider.stage.addEventListener("blur", () => this.hold(false));
    this.slider.stage.addEventListener("pointerleave", (event) => { if (event.pointerType !== "touch") this.look(this.at); });
    for (const type of ["pointerenter", "focusin", "keydown"]) section.addEventListener(type, () => this.load(), { once: true });
    for (const type of ["pointerdown", "keydown", "input", "change"]) section.addEventListener(type, () => { this.touched = true; }, true);
    addEventListener("hashchange", () => this.restore());
    this.arrange();
    if (this.restore()) addEventListener("load", () => section.scrollIntoView());
  }

  get light() { return this.$("compare-light").value; }
  get layout() { return this.$("compare-layout").value; }
  get left() { return this.panes[0].who.value; }
  /** The light whose picture this is, or null. */
  lightOf(what) {
    const start = ["S of ", "difference of ", "errors of "].find((s) => what.startsWith(s)), light = start && what.slice(start.length);
    return this.lights.includes(light) ? light : null;
  }
  choose(pane, who, what) {
    pane.who.value = who;
    for (const option of pane.what.options) option.disabled = !this.find(who, option.value);
    pane.what.value = this.find(who, what) ? what : [...pane.what.options].find((o) => !o.disabled).value;
  }
  follow(pane) {
    const light = this.lightOf(pane.what.value);
    if (light !== null) this.$("compare-light").value = light;
    this.show();
  }
  /** The reference's picture of the same; of a difference, which it has none of, its S. */
  reference(pane) {
    const what = pane.what.value, light = this.lightOf(what);
    return this.find("Reference", what) || (light !== null && this.find("Reference", "S of " + light)) || this.find("Reference", "picture");
  }
  show() {
    this.shown = this.slider.images.map((image, i) => {
      const pane = this.panes[i], figure = (this.held && this.reference(pane)) || this.find(pane.who.value, pane.what.value);
      if (image.src !== figure.src) image.src = figure.src;
      image.alt = figure.alt;
      // The filter multiplies stored values, which are about the 2.2th root of the light.
      image.style.filter = this.ev && figure.dataset.what === "picture" ? `brightness(${2 ** (this.ev / 2.2)})` : "";
      const words = `${figure.dataset.who}: ${figure.dataset.what}`, tag = this.section.querySelector(`.tag.${pane.name}`);
      if (tag) tag.textContent = words;
      this.slider.halves[i].dataset.tag = words;
      return figure.dataset;
    });
    this.$("exposure").textContent = this.ev ? `${signed(this.ev, 1)} EV` : "";
    this.refresh();
  }
  hold(on) {
    if (Boolean(this.held) === on) return;
    this.held = on;
    this.show();
  }
  arrange() {
    const slider = this.slider, count = this.layout === "4" ? 4 : 2;
    const [left, right, ...more] = this.panes, others = this.whos.filter((who) => who !== left.who.value && who !== right.who.value);
    for (const [i, pane] of more.entries()) if (!pane.chosen && others[i]) this.choose(pane, others[i], left.what.value);
    while (slider.halves.length > count) { slider.halves.pop().remove(); slider.images.pop(); }
    while (slider.halves.length < count) {
      const half = Object.assign(document.createElement("div"), { className: "half" }), { width, height } = slider;
      slider.images.push(half.appendChild(Object.assign(new Image(), { width, height })));
      slider.halves.push(half);
      slider.stage.append(half);
    }
    slider.panes = this.layout !== "slider";
    slider.root.dataset.layout = this.layout;
    slider.input.parentElement.hidden = slider.panes;
    slider.stage.setAttribute("aria-label", { slider: "Two pictures, one over the other", 2: "Two pictures, side by side", 4: "Four pictures" }[this.layout]);
    for (const name of ["third", "fourth"]) this.$(name).hidden = count < 4;
    this.show();
    slider.draw();
  }

  load() {
    if (this.loading || !this.slider) return;
    this.loading = true;
    window.umbraValues = (data) => {
      if (!data || data.schema !== 1 || data.width !== this.slider.width || data.height !== this.slider.height) return;
      this.values = new Values(data, () => this.refresh());
      this.$("values").hidden = false;
      this.$("no-values").hidden = true;
      const rows = data.columns.map(({ who }) => {
        const row = document.createElement("tr"), head = row.appendChild(document.createElement("th"));
        head.scope = "row";
        head.textContent = who;
        for (let k = 0; k < 3; ++k) row.insertCell();
        return row;
      });
      this.$("value-rows").replaceChildren(...rows);
      this.refresh();
    };
    const script = Object.assign(document.createElement("script"), { src: this.section.dataset.src });
    for (const type of ["load", "error"]) script.addEventListener(type, () => { this.$("no-values").hidden = Boolean(this.values); });
    document.head.append(script);
  }

  inside(p) { return p && p.x >= 0 && p.y >= 0 && p.x < this.slider.width && p.y < this.slider.height; }
  look(pixel) {
    this.seen = this.inside(pixel) ? pixel : this.at;
    this.refresh(false);
  }
  aim(pixel) {
    if (!this.inside(pixel)) return;
    this.at = this.seen = pixel;
    this.refresh(false);
  }
  /** The pixel stays in sight when keys move it. */
  aimByKey(dx, dy) {
    const s = this.slider, { w, h } = s.room, k = s.scale(), from = this.at || { x: Math.floor(s.x), y: Math.floor(s.y) };
    const keep = (v, most) => Math.min(Math.max(v, 0), most - 1);
    const to = this.at ? { x: keep(from.x + dx, s.width), y: keep(from.y + dy, s.height) } : from;
    if (this.selecting()) this.selectRegion(this.anchor ||= from, to);
    this.aim(to);
    if (Math.abs(to.x + 0.5 - s.x) > w / 2 / k - 1) s.x = to.x + 0.5;
    if (Math.abs(to.y + 0.5 - s.y) > h / 2 / k - 1) s.y = to.y + 0.5;
    s.draw();
    this.say();
  }
  /** For those who hear the page: what the crosshair has moved to. */
  say() {
    const row = [...this.$("value-rows").rows].find((r) => r.cells[0].textContent === this.left);
    this.readValues();
    this.$("said").textContent = this.$("pixel").textContent + (row ? ` ${this.left}: S ${[...row.cells].slice(1).map((c) => c.textContent).join(", ")}.` : "");
  }
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || "+=-0".includes(event.key)) return false;
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const digit = /^Digit([1-9])$/.exec(event.code), step = event.shiftKey ? -1 : 1;
    if (arrow) return event.shiftKey && (this.aimByKey(...arrow), true);
    if (digit) {
      const who = this.whos[digit[1] - 1], pane = this.panes[event.shiftKey ? 1 : 0];
      if (who) { this.choose(pane, who, pane.what.value); this.follow(pane); }
      return true;
    }
    const keys = {
      r: () => this.hold(true), f: () => this.flip(), n: () => { this.jump(step); this.say(); },
      e: () => { this.ev = Math.min(Math.max(this.ev + step / 2, -8), 8); this.show(); },
      o: () => { this.ev = 0; this.show(); }, escape: () => this.clearRegion(),
    };
    const act = keys[event.key.toLowerCase()];
    if (act) act();
    return Boolean(act);
  }
  flip() {
    const [a, b] = this.panes, kept = [a.who.value, a.what.value];
    this.choose(a, b.who.value, b.what.value);
    this.choose(b, ...kept);
    this.follow(a);
  }

  selecting(on) {
    const button = this.$("region-on");
    if (on !== undefined) { button.setAttribute("aria-pressed", on); this.anchor = null; this.slider.stage.classList.toggle("selecting", on); }
    return button.getAttribute("aria-pressed") === "true";
  }
  selectRegion(a, b) {
    const side = (v, most) => Math.min(Math.max(v, 0), most - 1), { width, height } = this.slider;
    const [x0, x1] = [side(a.x, width), side(b.x, width)].sort((p, q) => p - q), [y0, y1] = [side(a.y, height), side(b.y, height)].sort((p, q) => p - q);
    this.region = { x: x0, y: y0, w: x1 - x0 + 1, h: y1 - y0 + 1 };
    this.refresh();
  }
  clearRegion() {
    this.region = null;
    this.selecting(false);
    this.refresh();
  }
  /** Is it a wrong point of the class chosen? */
  wanted(c) { const chosen = this.$("wrong-class").value; return chosen === "any" ? isWrong(c) : this.values.classes[c] === chosen; }
  jump(step) {
    const s = this.slider, plane = this.values && this.values.plane(this.left, this.light);
    if (!plane || this.left === "Reference") return;
    const size = plane.length;
    let i = this.at ? this.at.y * s.width + this.at.x : step > 0 ? -1 : size;
    for (let k = 0; k < size; ++k) {
      i = (i + step + size) % size;
      if (!this.wanted(classOf(plane[i]))) continue;
      s.x = i % s.width + 0.5;
      s.y = Math.floor(i / s.width) + 0.5;
      this.aim({ x: Math.floor(s.x), y: Math.floor(s.y) });
      if (s.input.value < 55) s.input.value = 60;  // the left picture has to be seen in the middle
      return s.setZoom(Math.max(s.zoom, 8));
    }
  }

  /** Draws what has changed, once a frame: all, or only what depends on the view and the pointer. */
  refresh(all = true) {
    this.stale ||= all;
    if (!this.frame) this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      if (this.stale && this.values) this.count();
      this.stale = false;
      this.slider.halves.forEach((half, i) => this.drawOver(half, this.shown[i]));
      this.readValues();
      this.save();
    });
  }
  /** Everything that goes over all points: the mask, the classes to jump to, the statistics of the region. */
  count() {
    const { values, left, light } = this, $ = this.$, all = { x: 0, y: 0, w: values.width, h: values.height };
    const least = Math.round(100 * $("mask-least").value), counts = values.classes.map(() => 0);
    const context = (this.mask ||= Object.assign(document.createElement("canvas"), { width: all.w, height: all.h })).getContext("2d");
    const pixels = context.createImageData(all.w, all.h), words = new Uint32Array(pixels.data.buffer);
    let compared = 0, marked = 0;
    const known = values.compared(left, light, all, (i, d, c) => {
      ++compared;
      if (100 * Math.abs(d) > 255 * least) { ++marked; words[i] = 0xffc800ff; }
    });
    context.putImageData(pixels, 0, 0);
    $("mask-value").textContent = (least / 100).toFixed(2);
    $("mask-count").textContent = known ? `${marked} of ${compared} compared points of ${left} differ by more than ${(least / 100).toFixed(2)}.` : values.columns.some((column) => column.who === left) ? "" : `${left} has no values here.`;

    const plane = left !== "Reference" && values.plane(left, light);
    for (let i = 0; plane && i < plane.length; ++i) ++counts[classOf(plane[i])];
    const wrong = counts.map((n, c) => [values.classes[c], `${values.words(c)} (${n})`, n]).filter(([, , n], c) => n && isWrong(c));
    const select = $("wrong-class"), chosen = this.wantedClass || select.value;
    if (plane || left === "Reference") {
      select.replaceChildren(new Option(`any (${wrong.reduce((sum, w) => sum + w[2], 0)})`, "any"), ...wrong.map(([name, text]) => new Option(text, name)));
      select.value = wrong.some(([name]) => name === chosen) ? chosen : "any";
      this.wantedClass = null;
    }
    for (const id of ["wrong-previous", "wrong-next"]) $(id).disabled = !wrong.length;

    const r = this.region, by = new Map();
    let n = 0, sum = 0, squares = 0, largest = 0;
    $("region-facts").hidden = $("region-clear").hidden = !r;
    if (!r) return;
    values.compared(left, light, r, (i, d, c) => {
      ++n;
      sum += Math.abs(d) / 255;
      squares += (d / 255) ** 2;
      if (Math.abs(d) > Math.abs(largest)) largest = d;
      if (c >= kWrong) by.set(c, (by.get(c) || 0) + 1);
    });
    const figures = {
      Region: `${r.w} × ${r.h} pixels from ${r.x}, ${r.y}`, Compared: `${n} points`,
      Wrong: [...by].sort((a, b) => a[0] - b[0]).map(([c, k]) => `${k} ${values.words(c)}`).join("; ") || "none",
      "Mean |difference|": n ? (sum / n).toFixed(4) : "–", RMSE: n ? Math.sqrt(squares / n).toFixed(4) : "–", "Largest difference": n ? signed(largest / 255, 4) : "–",
    };
    $("region-facts").replaceChildren(...Object.entries(figures).flatMap((pair) => pair.map((text, k) => Object.assign(document.createElement(k ? "dd" : "dt"), { textContent: text }))));
  }
  readValues() {
    const { values, seen } = this, $ = this.$, i = seen && seen.y * this.slider.width + seen.x;
    const surface = seen && values ? values.surface(i) : "";
    $("pixel").textContent = seen ? `Pixel ${seen.x}, ${seen.y}${surface && ": " + surface}.` : "Point at a picture, or press Shift and an arrow key there.";
    if (!values) return;
    for (const [k, { who, truth: other }] of values.columns.entries()) {
      const plane = values.plane(who, this.light), truth = values.truth(who, this.light), cells = $("value-rows").rows[k].cells, value = plane && seen ? plane[i] : null, c = classOf(value);
      const given = value !== null && value & kAnswered && c > 0, isTruth = !other;
      cells[1].textContent = value === null ? "" : given ? (sOf(value) / 255).toFixed(3) : c > 0 ? "no answer" : "–";
      cells[2].textContent = given && !isTruth && truth && truth[i] & kAnswered ? signed((sOf(value) - sOf(truth[i])) / 255, 3) : value === null ? "" : "–";
      cells[3].textContent = value === null ? "" : isTruth ? "–" : values.words(c);
      cells[3].classList.toggle("wrong", !isTruth && isWrong(c));
    }
  }
  /** Mask, numbers, crosshair and region, over one half. */
  drawOver(half, shown) {
    const canvas = half.querySelector("canvas") || half.appendChild(document.createElement("canvas")), ratio = devicePixelRatio;
    const slider = this.slider, { w, h } = slider.room, s = slider.scale(), corner = slider.corner(), { width, height } = slider;
    Object.assign(canvas, { width: Math.round(w * ratio), height: Math.round(h * ratio) });
    const c = canvas.getContext("2d"), x0 = Math.max(0, Math.floor(-corner.x / s)), y0 = Math.max(0, Math.floor(-corner.y / s));
    const x1 = Math.min(width, Math.ceil((w - corner.x) / s)), y1 = Math.min(height, Math.ceil((h - corner.y) / s));
    c.scale(ratio, ratio);
    c.translate(corner.x, corner.y);
    if (this.mask && this.$("mask-on").checked) {
      c.globalAlpha = 0.65;
      c.imageSmoothingEnabled = s < 1;
      c.drawImage(this.mask, x0, y0, x1 - x0, y1 - y0, x0 * s, y0 * s, (x1 - x0) * s, (y1 - y0) * s);
      c.globalAlpha = 1;
    }
    if (s >= 32 && this.values) this.drawNumbers(c, shown, s, x0, y0, x1, y1);
    const outline = (x, y, ww, hh, dash) => {
      for (const [line, colour] of [[4, "#000"], [2, "#fff"]]) {
        Object.assign(c, { lineWidth: line, strokeStyle: colour });
        c.setLineDash(line === 2 ? dash : []);
        c.strokeRect(x, y, ww, hh);
      }
    };
    const r = this.region, at = this.at, size = Math.max(s, 9);
    if (r) outline(r.x * s, r.y * s, r.w * s, r.h * s, [6, 4]);
    if (at) outline((at.x + 0.5) * s - size / 2, (at.y + 0.5) * s - size / 2, size, size, []);
  }
  drawNumbers(c, { who, what }, s, x0, y0, x1, y1) {
    const light = this.lightOf(what) ?? this.light, plane = this.values.plane(who, light), truth = this.values.truth(who, light);
    if (!plane || !truth) return;
    const text = (v, t) => {
      if (what.startsWith("errors of ")) return this.values.words(classOf(v), 1);
      if (!classOf(v)) return "";
      if (!(v & kAnswered)) return "?";
      if (!what.startsWith("difference of ")) return (sOf(v) / 255).toFixed(2);
      return t & kAnswered ? signed((sOf(v) - sOf(t)) / 255, 2) : "?";
    };
    // Dark figures where the picture is known to be light.
    const isLight = (v, t) => what.startsWith("S of ") ? sOf(v) > 127 && classOf(v) > 0 : what.startsWith("difference of ") && classOf(v) > 0 && Math.abs(sOf(v) - sOf(t)) < 100;
    Object.assign(c, { font: `600 ${Math.min(Math.max(0.3 * s, 10), 17)}px system-ui, sans-serif`, textAlign: "center", textBaseline: "middle", lineWidth: 2, lineJoin: "round" });
    for (let y = y0; y < y1; ++y) {
      for (let x = x0; x < x1; ++x) {
        const i = y * this.slider.width + x, place = [text(plane[i], truth[i]), (x + 0.5) * s, (y + 0.5) * s, s - 3];
        [c.fillStyle, c.strokeStyle] = isLight(plane[i], truth[i]) ? ["#000", "#fff"] : ["#fff", "#000"];
        c.strokeText(...place);
        c.fillText(...place);
      }
    }
  }

  /** The view, as the address holds it. */
  state() {
    const s = this.slider, state = new URLSearchParams(), $ = this.$, short = (v) => String(Number(v.toFixed(2)));
    for (const pane of this.panes.slice(0, s.halves.length)) {
      state.set(pane.name, pane.who.value);
      state.set(pane.name + "What", pane.what.value);
    }
    if (this.lights.length) state.set("light", this.light);
    state.set("layout", this.layout);
    state.set("divider", short(Number(s.input.value)));
    if (s.zoomed()) for (const key of ["zoom", "x", "y"]) state.set(key, short(s[key]));
    if ($("mask-on").checked) state.set("mask", $("mask-least").value);
    if (this.ev) state.set("ev", this.ev);
    const chosen = this.wantedClass || $("wrong-class").value;
    if (chosen && chosen !== "any") state.set("class", chosen);
    if (this.region) state.set("region", ["x", "y", "w", "h"].map((key) => this.region[key]).join());
    if (this.at) state.set("at", `${this.at.x},${this.at.y}`);
    return String(state);
  }
  save() {
    if (!this.touched) return;
    clearTimeout(this.timer);  // browsers count how often a page changes its address
    this.timer = setTimeout(() => {
      const state = this.state();
      if (state === this.saved) return;
      this.saved = state;
      try { history.replaceState(null, "", "#" + state); } catch { /* some browsers forbid it to pages from disk */ }
    }, 200);
  }
  /** Takes the view from the address; what is unknown or out of range there is as if it were not there. */
  restore() {
    const hash = location.hash.slice(1), p = new URLSearchParams(hash), s = this.slider, $ = this.$;
    const keys = ["left", "right", "third", "fourth", "light", "layout", "divider", "zoom", "mask", "ev", "region", "at", "leftWhat", "rightWhat"];
    if (!hash.includes("=") || hash === this.saved || !keys.some((key) => p.has(key))) return false;
    const number = (text, least, most) => /^-?\d{1,6}(\.\d{1,6})?$/.test(text) && Number(text) >= least && Number(text) <= most ? Number(text) : null;
    const whole = (key, most) => {
      const parts = (p.get(key) || "").split(",").map((text, k) => number(text, 0, most[k]));
      return parts.length === most.length && parts.every((v) => Number.isInteger(v)) ? parts : null;
    };
    for (const pane of this.panes) {
      const who = p.get(pane.name), what = p.get(pane.name + "What");
      pane.chosen ||= this.whos.includes(who);
      this.choose(pane, this.whos.includes(who) ? who : pane.who.value, this.whats.includes(what) ? what : pane.what.value);
    }
    if (this.lights.includes(p.get("light"))) $("compare-light").value = p.get("light");
    if (["slider", "2", "4"].includes(p.get("layout"))) $("compare-layout").value = p.get("layout");
    s.input.value = number(p.get("divider"), 0, 100) ?? s.input.value;
    const mask = number(p.get("mask"), 0, 1), at = whole("at", [s.width - 1, s.height - 1]), r = whole("region", [s.width - 1, s.height - 1, s.width, s.height]);
    $("mask-on").checked = mask !== null;
    if (mask !== null) $("mask-least").value = mask;
    this.ev = Math.round(2 * (number(p.get("ev"), -8, 8) ?? 0)) / 2;
    this.wantedClass = Object.hasOwn(kClasses, p.get("class")) ? p.get("class") : null;
    this.region = r && r[2] && r[3] && r[0] + r[2] <= s.width && r[1] + r[3] <= s.height ? { x: r[0], y: r[1], w: r[2], h: r[3] } : null;
    this.at = this.seen = at && { x: at[0], y: at[1] };
    this.arrange();
    const zoom = number(p.get("zoom"), 0, 64);
    s.x = number(p.get("x"), 0, s.width) ?? s.width / 2;
    s.y = number(p.get("y"), 0, s.height) ?? s.height / 2;
    s.setZoom(zoom ?? 0);
    this.load();
    return true;
  }
  async copyAddress() {
    const address = location.href.split("#")[0] + "#" + this.state();
    try {
      await navigator.clipboard.writeText(address);
      this.$("copied").textContent = "Copied.";
    } catch {
      this.touched = true;
      this.save();
      this.$("copied").textContent = "Not allowed here: copy it from the address bar.";
    }
  }
}

const compareSection = document.getElementById("compare");
if (compareSection && document.querySelectorAll("img[data-who]").length > 1) new Compare(compareSection);
