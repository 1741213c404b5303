// The finder of the cheapest methods of each scene. The page works without it.
"use strict";

/** The number that a field or an attribute holds; NaN where it holds none. */
function numberIn(text) { return text === undefined || text.trim() === "" ? NaN : Number(text); }

/**
 * The places of the cheapest of `methods`, each {mae, cover (0 to 1), ms, interior}, within `limits`, {mae, cover (%)}:
 * all that the noise bar does not tell from the least time. A limit that is NaN limits nothing; a noise bar that is NaN
 * tells all apart. A method with wrong interior points wins only where all others have some, too.
 */
function cheapest(methods, limits, noise) {
  const within = methods.filter((m) => m.ms >= 0 && !Number.isNaN(m.interior) && (Number.isNaN(limits.mae) || m.mae <= limits.mae) &&
    (Number.isNaN(limits.cover) || m.cover * 100 >= limits.cover));
  const clean = within.filter((m) => m.interior === 0);
  const able = clean.length ? clean : within, least = Math.min(...able.map((m) => m.ms));
  return able.filter((m) => m.ms <= least * (1 + (noise || 0))).map((m) => methods.indexOf(m));
}

function startFinder(form) {
  const mae = document.getElementById("largest-mae"), cover = document.getElementById("least-cover"), found = document.getElementById("found");
  const rows = [...document.querySelectorAll("#summary .matrix tbody tr")];
  function mark() {
    let served = 0, faulty = 0, loud = 0;
    for (const row of rows) {
      const cells = [...row.querySelectorAll("td.ms")];
      for (const cell of cells) { cell.classList.remove("cheapest"); cell.querySelector(".mark")?.remove(); }
      const methods = cells.map(({ dataset }) => ({
        mae: numberIn(dataset.mae), cover: numberIn(dataset.cover), ms: numberIn(dataset.ms), interior: numberIn(dataset.interior),
      }));
      const best = cheapest(methods, { mae: numberIn(mae.value), cover: numberIn(cover.value) }, numberIn(row.dataset.noise));
      if (!best.length) continue;
      if (row.dataset.loud !== undefined) { ++loud; continue; }
      ++served;
      if (methods[best[0]].interior > 0) ++faulty;
      for (const place of best) {
        cells[place].classList.add("cheapest");
        cells[place].insertAdjacentHTML("afterbegin", '<span class="mark"><span aria-hidden="true">★ </span><span class="hidden">cheapest: </span></span>');
      }
    }
    const scenes = (n) => `${n} ${n === 1 ? "scene" : "scenes"}`;
    found.textContent = `A star marks the cheapest method within these limits and all that noise does not tell from it; there is one on ${served} of ${scenes(rows.length)}.` +
      (loud ? ` On ${scenes(loud)} times vary by more than 30 %, or are of fewer than six rounds: nothing is marked.` : "") +
      (faulty ? ` On ${scenes(faulty)} every such method has wrong interior points.` : "");
  }
  form.hidden = false;
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("input", mark);
  mark();
}

if (typeof document !== "undefined") {
  const finder = document.querySelector(".finder");
  if (finder) startFinder(finder);
}
