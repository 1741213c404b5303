// The slider that compares two pictures of a page, and the finder of the cheapest method. The pages work without it.
"use strict";

// ---- Two pictures, one over the other. What there is to show is read from the page's own figures.
function startCompare(root) {
  const $ = (id) => document.getElementById(id);
  const figures = [...document.querySelectorAll("img[data-who]")];
  if (figures.length < 2) return;
  const whos = [...new Set(figures.map((f) => f.dataset.who))];
  const whats = [...new Set(figures.map((f) => f.dataset.what))].sort((a, b) => rank(a) - rank(b));
  function rank(what) { return what === "picture" ? 0 : what.startsWith("S of") ? 1 : what.startsWith("difference") ? 2 : what.startsWith("errors") ? 3 : 4; }
  const find = (who, what) => figures.find((f) => f.dataset.who === who && f.dataset.what === what);

  const stage = $("stage"), slide = $("divide"), divider = $("divider");
  const sides = ["left", "right"].map((name) => ({
    who: $(name + "-who"), what: $(name + "-what"), half: $(name + "-half"), img: $(name + "-half").firstElementChild, tag: $(name + "-tag"),
  }));
  const width = Number(figures[0].getAttribute("width")) || figures[0].naturalWidth || 640;
  const height = Number(figures[0].getAttribute("height")) || figures[0].naturalHeight || 360;
  let zoom = 0, x = width / 2, y = height / 2;  // zoom: screen pixels a picture pixel, 0 fits; x, y: the picture's point in the middle

  const scale = () => zoom || stage.clientWidth / width;
  function draw() {
    stage.style.height = Math.min(stage.clientWidth * height / width, Math.max(240, innerHeight * 0.8)) + "px";
    const s = scale(), w = stage.clientWidth, h = stage.clientHeight;
    const hold = (at, size, room) => size * s <= room ? size / 2 : Math.min(Math.max(at, room / 2 / s), size - room / 2 / s);
    x = hold(x, width, w);
    y = hold(y, height, h);
    for (const { img } of sides) {
      img.style.width = width * s + "px";
      img.style.height = height * s + "px";
      img.style.left = Math.round(w / 2 - x * s) + "px";
      img.style.top = Math.round(h / 2 - y * s) + "px";
    }
    stage.classList.toggle("crisp", s * devicePixelRatio >= 1);
    stage.classList.toggle("zoomed", width * s > w + 1 || height * s > h + 1);
    sides[0].half.style.clipPath = `inset(0 ${100 - slide.value}% 0 0)`;
    divider.style.left = slide.value + "%";
    $("zoom-now").textContent = zoom ? `${zoom} ×` : "fit";
    $("zoom-out").disabled = zoom === 0;
    $("zoom-in").disabled = zoom >= 32;
  }
  function show(side) {
    for (const option of side.what.options) option.disabled = !find(side.who.value, option.value);
    if (!find(side.who.value, side.what.value)) side.what.value = [...side.what.options].find((o) => !o.disabled).value;
    const figure = find(side.who.value, side.what.value);
    side.img.src = figure.src;
    side.img.alt = figure.alt;
    side.tag.textContent = `${side.who.value}: ${side.what.value}`;
  }
  function setZoom(next, at) {
    const s = scale();
    if (at) { x += (at.x - stage.clientWidth / 2) / s; y += (at.y - stage.clientHeight / 2) / s; }
    zoom = next;
    if (at) { const t = scale(); x -= (at.x - stage.clientWidth / 2) / t; y -= (at.y - stage.clientHeight / 2) / t; }
    draw();
  }
  const levels = () => [1, 2, 4, 8, 16, 32].filter((z) => z > stage.clientWidth / width);
  const zoomIn = (at) => setZoom(levels().find((z) => z > zoom) || zoom, at);
  const zoomOut = (at) => setZoom(levels().filter((z) => z < zoom).pop() || 0, at);

  for (const [i, side] of sides.entries()) {
    for (const who of whos) side.who.add(new Option(who));
    for (const what of whats) side.what.add(new Option(what));
    side.who.value = whos[Math.min(i ? 0 : 1, whos.length - 1)];
    for (const select of [side.who, side.what]) select.addEventListener("change", () => show(side));
    show(side);
  }
  slide.addEventListener("input", draw);
  $("zoom-in").addEventListener("click", () => zoomIn());
  $("zoom-out").addEventListener("click", () => zoomOut());
  $("zoom-fit").addEventListener("click", () => setZoom(0));

  const place = (event) => { const box = stage.getBoundingClientRect(); return { x: event.clientX - box.left, y: event.clientY - box.top }; };
  let drag = null;
  stage.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    drag = { pan: stage.classList.contains("zoomed") && event.target !== divider, x: event.clientX, y: event.clientY };
    stage.setPointerCapture(event.pointerId);
    move(event);
  });
  function move(event) {
    const at = place(event), s = scale();
    const px = Math.floor(x + (at.x - stage.clientWidth / 2) / s), py = Math.floor(y + (at.y - stage.clientHeight / 2) / s);
    $("pixel").textContent = px >= 0 && py >= 0 && px < width && py < height ? `Pixel ${px}, ${py}.` : "";
    if (!drag) return;
    if (drag.pan) {
      x -= (event.clientX - drag.x) / s;
      y -= (event.clientY - drag.y) / s;
      drag.x = event.clientX;
      drag.y = event.clientY;
    } else {
      slide.value = 100 * at.x / stage.clientWidth;
    }
    draw();
  }
  stage.addEventListener("pointermove", move);
  for (const end of ["pointerup", "pointercancel"]) stage.addEventListener(end, () => { drag = null; });
  stage.addEventListener("dblclick", (event) => zoomIn(place(event)));
  stage.addEventListener("keydown", (event) => {
    const step = 40 / scale();
    const keys = {
      ArrowLeft: () => { x -= step; draw(); }, ArrowRight: () => { x += step; draw(); },
      ArrowUp: () => { y -= step; draw(); }, ArrowDown: () => { y += step; draw(); },
      "+": () => zoomIn(), "=": () => zoomIn(), "-": () => zoomOut(), 0: () => setZoom(0),
    };
    if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
    if (event.key.startsWith("Arrow") && !stage.classList.contains("zoomed")) return;
    event.preventDefault();
    keys[event.key]();
  });

  root.hidden = false;
  new ResizeObserver(draw).observe(stage);
  draw();
}

// ---- The cheapest method of each scene within an error
function startFinder(form) {
  const mae = document.getElementById("largest-mae"), cover = document.getElementById("least-cover"), found = document.getElementById("found");
  function mark() {
    const rows = [...document.querySelectorAll(".matrix tbody tr")];
    let served = 0;
    for (const row of rows) {
      const cells = [...row.querySelectorAll("td.ms")];
      for (const cell of cells) { cell.classList.remove("cheapest"); cell.removeAttribute("title"); cell.querySelector(".mark")?.remove(); }
      const good = cells.filter((c) => c.dataset.mae !== "" && c.dataset.ms !== "" && Number(c.dataset.mae) <= Number(mae.value) && Number(c.dataset.cover) * 100 >= Number(cover.value));
      const best = good.sort((a, b) => a.dataset.ms - b.dataset.ms)[0];
      if (!best) continue;
      ++served;
      best.classList.add("cheapest");
      best.insertAdjacentHTML("afterbegin", '<span class="mark"><span aria-hidden="true">★ </span><span class="hidden">cheapest: </span></span>');
    }
    found.textContent = `A star marks the cheapest: ${served} of ${rows.length} scenes have a method that does.`;
  }
  form.hidden = false;
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("input", mark);
  mark();
}

const compare = document.querySelector(".compare"), finder = document.querySelector(".finder");
if (compare) startCompare(compare);
if (finder) startFinder(finder);
// Once the page stands, the pictures that nobody scrolled to yet are loaded, too: paper shows them all.
addEventListener("load", () => document.querySelectorAll("img[loading]").forEach((img) => { img.loading = "eager"; }));
