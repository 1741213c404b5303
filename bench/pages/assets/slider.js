// The slider that compares two pictures, one over the other, and the controls that choose them on a scene's page.
// Without JavaScript the front page shows the pair divided in the middle.
"use strict";

/** One slider. With `zoom` it also zooms, and a drag then moves the picture. */
class Slider {
  constructor(root, { zoom = false, changed = () => {}, hover = () => {} } = {}) {
    this.root = root;
    this.stage = root.querySelector(".stage");
    this.input = root.querySelector("input");
    this.divider = root.querySelector(".divider");
    this.halves = ["left", "right"].map((side) => root.querySelector(`.half.${side}`));
    this.images = this.halves.map((half) => half.querySelector("img") || half.appendChild(new Image()));
    this.canZoom = zoom;
    this.changed = changed;
    this.hover = hover;
    this.zoom = 0;  // screen pixels a picture pixel; 0 fits
    const sized = () => {
      const [image] = this.images;
      this.width = Number(image.getAttribute("width")) || image.naturalWidth || 16;
      this.height = Number(image.getAttribute("height")) || image.naturalHeight || 9;
      root.style.setProperty("--w", this.width);
      root.style.setProperty("--h", this.height);
      this.x = this.width / 2;  // the point of the picture in the middle of the stage
      this.y = this.height / 2;
      this.draw();
    };
    sized();
    if (!this.images[0].hasAttribute("width")) this.images[0].addEventListener("load", sized);
    this.input.addEventListener("input", () => this.draw());
    this.input.parentElement.hidden = false;
    this.listen();
    new ResizeObserver(() => this.draw()).observe(this.stage);
  }

  /** The stage has the picture's shape at every window size, so that one scale fits both ways. */
  fit() { return this.stage.clientWidth / this.width; }
  scale() { return Math.max(this.zoom, this.fit()); }
  zoomed() { return this.zoom > this.fit(); }
  levels() { return [1, 2, 4, 8, 16, 32].filter((z) => z > this.fit()); }

  draw() {
    const s = this.scale(), w = this.stage.clientWidth, h = this.stage.clientHeight;
    const hold = (at, size, room) => Math.min(Math.max(at, room / 2 / s), Math.max(size - room / 2 / s, size / 2));
    this.x = hold(this.x, this.width, w);
    this.y = hold(this.y, this.height, h);
    for (const image of this.images) {
      image.style.width = this.width * s + "px";
      image.style.height = this.height * s + "px";
      image.style.left = (this.zoomed() ? Math.round(w / 2 - this.x * s) : 0) + "px";
      image.style.top = (this.zoomed() ? Math.round(h / 2 - this.y * s) : 0) + "px";
    }
    this.stage.classList.toggle("crisp", s * devicePixelRatio > 1);
    this.stage.classList.toggle("zoomed", this.zoomed());
    this.halves[0].style.clipPath = `inset(0 ${100 - this.input.value}% 0 0)`;
    this.divider.style.left = this.input.value + "%";
    this.changed(this);
  }

  setZoom(next, at) {
    const middle = { x: this.stage.clientWidth / 2, y: this.stage.clientHeight / 2 }, before = this.scale();
    this.zoom = next;
    const after = this.scale();
    if (at) {  // what is under the pointer stays there
      this.x += (at.x - middle.x) * (1 / before - 1 / after);
      this.y += (at.y - middle.y) * (1 / before - 1 / after);
    }
    this.draw();
  }
  zoomIn(at) { this.setZoom(this.levels().find((z) => z > this.zoom) || this.zoom, at); }
  zoomOut(at) { this.setZoom(this.levels().filter((z) => z < this.zoom).pop() || 0, at); }

  divide(percent) {
    this.input.value = percent;
    this.draw();
  }

  listen() {
    const stage = this.stage;
    const place = (event) => { const box = stage.getBoundingClientRect(); return { x: event.clientX - box.left, y: event.clientY - box.top }; };
    let drag = null;
    const move = (event) => {
      const at = place(event), s = this.scale();
      this.hover(Math.floor(this.x + (at.x - stage.clientWidth / 2) / s), Math.floor(this.y + (at.y - stage.clientHeight / 2) / s));
      if (!drag) return;
      if (!drag.pan) return this.divide(100 * at.x / stage.clientWidth);
      this.x -= (event.clientX - drag.x) / s;
      this.y -= (event.clientY - drag.y) / s;
      drag = { pan: true, x: event.clientX, y: event.clientY };
      this.draw();
    };
    stage.addEventListener("pointerdown", (event) => {
      if (event.button) return;
      drag = { pan: this.zoomed() && event.target !== this.divider, x: event.clientX, y: event.clientY };
      stage.setPointerCapture(event.pointerId);
      move(event);
    });
    stage.addEventListener("pointermove", move);
    for (const end of ["pointerup", "pointercancel"]) stage.addEventListener(end, () => { drag = null; });
    if (this.canZoom) stage.addEventListener("dblclick", (event) => this.zoomIn(place(event)));
    stage.addEventListener("keydown", (event) => {
      const pan = (dx, dy) => { this.x += 40 * dx / this.scale(); this.y += 40 * dy / this.scale(); this.draw(); };
      const step = (by) => this.divide(Number(this.input.value) + by);
      const keys = this.zoomed()
        ? { ArrowLeft: () => pan(-1, 0), ArrowRight: () => pan(1, 0), ArrowUp: () => pan(0, -1), ArrowDown: () => pan(0, 1) }
        : { ArrowLeft: () => step(-1), ArrowRight: () => step(1) };
      if (this.canZoom) Object.assign(keys, { "+": () => this.zoomIn(), "=": () => this.zoomIn(), "-": () => this.zoomOut(), 0: () => this.setZoom(0) });
      if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });
  }
}

/** The section "Compare two pictures": everything that the page's figures show can be chosen for either side. */
function startCompare(section) {
  const $ = (id) => document.getElementById(id);
  const figures = [...document.querySelectorAll("img[data-who]")];
  if (figures.length < 2) return;
  const rank = (what) => ["picture", "S of", "difference", "errors"].findIndex((start) => what.startsWith(start)) >>> 0;
  const whos = [...new Set(figures.map((f) => f.dataset.who))];
  const whats = [...new Set(figures.map((f) => f.dataset.what))].sort((a, b) => rank(a) - rank(b));
  const find = (who, what) => figures.find((f) => f.dataset.who === who && f.dataset.what === what);

  section.hidden = false;
  for (const link of document.querySelectorAll('a[href="#compare"]')) link.parentElement.hidden = false;
  const slider = new Slider(section.querySelector(".slider"), {
    zoom: true,
    changed(slider) {
      $("zoom-now").textContent = slider.zoomed() ? `${slider.zoom} ×` : "fit";
      $("zoom-out").disabled = !slider.zoomed();
      $("zoom-in").disabled = slider.zoom >= 32;
    },
    hover(x, y) { $("pixel").textContent = x >= 0 && y >= 0 && x < slider.width && y < slider.height ? `Pixel ${x}, ${y}.` : ""; },
  });
  for (const [i, name] of ["left", "right"].entries()) {
    const who = $(name + "-who"), what = $(name + "-what"), tag = section.querySelector(`.tag.${name}`);
    const show = () => {
      for (const option of what.options) option.disabled = !find(who.value, option.value);
      if (!find(who.value, what.value)) what.value = [...what.options].find((o) => !o.disabled).value;
      const figure = find(who.value, what.value);
      slider.images[i].src = figure.src;
      slider.images[i].alt = figure.alt;
      tag.textContent = `${who.value}: ${what.value}`;
    };
    for (const option of whos) who.add(new Option(option));
    for (const option of whats) what.add(new Option(option));
    who.value = whos.includes(tag.textContent) ? tag.textContent : whos[0];  // the pair that the page was written with
    for (const select of [who, what]) select.addEventListener("change", show);
    show();
  }
  $("zoom-in").addEventListener("click", () => slider.zoomIn());
  $("zoom-out").addEventListener("click", () => slider.zoomOut());
  $("zoom-fit").addEventListener("click", () => slider.setZoom(0));
  slider.draw();
}

const compare = document.getElementById("compare");
if (compare) startCompare(compare);
for (const root of document.querySelectorAll(".front .slider")) new Slider(root);
