// The slider that compares two pictures, one over the other. Without JavaScript the front page shows the pair divided
// in the middle.
"use strict";

/** One slider. With `zoom` it also zooms, and a drag then moves the picture. Its halves can also stand apart, as
    `panes`: then all of them show the same part. What else a drag, a click or a key does is up to the page:
    `selects(event)` says that a drag selects, `keys(event)` that a key was taken. */
class Slider {
  constructor(root, { zoom = false, changed = () => {}, hover = () => {}, click = () => {}, selects = () => false, select = () => {}, keys = () => false } = {}) {
    this.root = root;
    this.stage = root.querySelector(".stage");
    this.input = root.querySelector("input");
    this.divider = root.querySelector(".divider");
    this.halves = ["left", "right"].map((side) => root.querySelector(`.half.${side}`));
    this.images = this.halves.map((half) => half.querySelector("img") || half.appendChild(new Image()));
    this.canZoom = zoom;
    this.panes = false;
    Object.assign(this, { changed, hover, click, selects, select, keys });
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

  /** A half has the picture's shape at every window size, so that one scale fits both ways. */
  get room() { return { w: this.halves[0].clientWidth, h: this.halves[0].clientHeight }; }
  fit() { return this.room.w / this.width; }
  scale() { return Math.max(this.zoom, this.fit()); }
  zoomed() { return this.zoom > this.fit(); }
  levels() { return [1, 2, 4, 8, 16, 32, 64].filter((z) => z > this.fit()); }
  /** Where the picture's upper left corner is, from that of the half. */
  corner() {
    const { w, h } = this.room, s = this.scale();
    return this.zoomed() ? { x: Math.round(w / 2 - this.x * s), y: Math.round(h / 2 - this.y * s) } : { x: 0, y: 0 };
  }

  draw() {
    const s = this.scale(), { w, h } = this.room;
    const hold = (at, size, room) => Math.min(Math.max(at, room / 2 / s), Math.max(size - room / 2 / s, size / 2));
    this.x = hold(this.x, this.width, w);
    this.y = hold(this.y, this.height, h);
    const corner = this.corner();
    for (const image of this.images) {
      image.style.width = this.width * s + "px";
      image.style.height = this.height * s + "px";
      image.style.left = corner.x + "px";
      image.style.top = corner.y + "px";
    }
    this.stage.classList.toggle("crisp", s * devicePixelRatio > 1);
    this.stage.classList.toggle("zoomed", this.zoomed());
    this.halves[0].style.clipPath = this.panes ? "none" : `inset(0 ${100 - this.input.value}% 0 0)`;
    this.divider.style.left = this.input.value + "%";
    this.changed(this);
  }

  setZoom(next, at) {
    const { w, h } = this.room, before = this.scale();
    this.zoom = next;
    const after = this.scale();
    if (at) {  // what is under the pointer stays there
      this.x += (at.x - w / 2) * (1 / before - 1 / after);
      this.y += (at.y - h / 2) * (1 / before - 1 / after);
    }
    this.draw();
  }
  zoomIn(at) { this.setZoom(this.levels().find((z) => z > this.zoom) || this.zoom, at); }
  zoomOut(at) { this.setZoom(this.levels().filter((z) => z < this.zoom).pop() || 0, at); }
  /** Any scale from the one that fits to the largest level, as fingers give it. */
  zoomTo(scale, at) { this.setZoom(scale > this.fit() ? Math.min(scale, 64) : 0, at); }

  divide(percent) {
    this.input.value = percent;
    this.draw();
  }

  listen() {
    const stage = this.stage, touches = new Map();
    let drag = null, pinch = null;
    const place = (event) => {  // in the half that it is over
      const boxes = this.halves.map((half) => half.getBoundingClientRect());
      const box = boxes.find((b) => event.clientX >= b.left && event.clientX < b.right && event.clientY >= b.top && event.clientY < b.bottom) || boxes[0];
      return { x: event.clientX - box.left, y: event.clientY - box.top };
    };
    const pixel = (event) => {
      const at = place(event), corner = this.corner(), s = this.scale();
      return { x: Math.floor((at.x - corner.x) / s), y: Math.floor((at.y - corner.y) / s) };
    };
    const fingers = () => {
      const [a, b] = [...touches.values()];
      return { apart: Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY), at: place({ clientX: (a.clientX + b.clientX) / 2, clientY: (a.clientY + b.clientY) / 2 }) };
    };
    const move = (event) => {
      if (touches.has(event.pointerId)) touches.set(event.pointerId, event);
      if (pinch) {
        const now = fingers();
        return this.zoomTo(pinch.scale * now.apart / pinch.apart, now.at);
      }
      this.hover(pixel(event));
      if (!drag) return;
      if (Math.hypot(event.clientX - drag.start.clientX, event.clientY - drag.start.clientY) > 3) drag.moved = true;
      if (drag.from) return this.select(drag.from, pixel(event));
      if (!drag.pan) return this.divide(100 * place(event).x / this.room.w);
      this.x -= (event.clientX - drag.x) / this.scale();
      this.y -= (event.clientY - drag.y) / this.scale();
      Object.assign(drag, { x: event.clientX, y: event.clientY });
      this.draw();
    };
    stage.addEventListener("pointerdown", (event) => {
      if (event.button) return;
      if (event.pointerType === "touch") touches.set(event.pointerId, event);
      stage.setPointerCapture(event.pointerId);
      if (this.canZoom && touches.size === 2) {
        drag = null;
        pinch = { ...fingers(), scale: this.scale() };
        return;
      }
      drag = { start: event, x: event.clientX, y: event.clientY, from: this.selects(event) && pixel(event), pan: this.panes || (this.zoomed() && event.target !== this.divider) };
      move(event);
    });
    stage.addEventListener("pointermove", move);
    for (const end of ["pointerup", "pointercancel"]) {
      stage.addEventListener(end, (event) => {
        if (drag && drag.pan && !drag.from && !drag.moved && end === "pointerup") this.click(pixel(event));
        touches.delete(event.pointerId);
        drag = pinch = null;
      });
    }
    if (this.canZoom) {
      stage.addEventListener("dblclick", (event) => this.zoomIn(place(event)));
      stage.addEventListener("wheel", (event) => {  // fingers on a touchpad; without Ctrl the page scrolls
        if (!event.ctrlKey) return;
        event.preventDefault();
        this.zoomTo(this.scale() * Math.exp(-event.deltaY / 100), place(event));
      }, { passive: false });
    }
    stage.addEventListener("keydown", (event) => {
      if (this.keys(event)) return event.preventDefault();
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

for (const root of document.querySelectorAll(".front .slider")) new Slider(root);
