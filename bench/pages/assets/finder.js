// The finder of the cheapest method of each scene. The page works without it.
"use strict";

/** The number that a field or an attribute holds; NaN where it holds none. */
function numberIn(text) { return text === undefined || text.trim() === "" ? NaN : Number(text); }

/**
 * The place of the cheapest of `methods`, each {mae, cover (0 to 1), ms, interior}, within `limits`, {mae, cover (%)};
 * a limit that is NaN limits nothing. A method with wrong interior points wins only where all others have some, too.
 * -1 where none is within the limits.
 */
function cheapest(methods, limits) {
  const within = methods.filter((m) => m.ms >= 0 && !Number.isNaN(m.interior) && (Number.isNaN(limits.mae) || m.mae <= limits.mae) &&
    (Number.isNaN(limits.cover) || m.cover * 100 >= limits.cover));
  const clean = within.filter((m) => m.interior === 0);
  const [best] = (clean.length ? clean : within).sort((a, b) => a.ms - b.ms);
  return methods.indexOf(best);
}

function startFinder(form) {
  const mae = document.getElementById("largest-mae"), cover = document.getElementById("least-cover"), found = document.getElementById("found");
  const rows = [...document.querySelectorAll("#summary .matrix tbody tr")];
  function mark() {
    let served = 0, faulty = 0;
    for (const row of rows) {
      const cells = [...row.querySelectorAll("td.ms")];
      for (const cell of cells) { cell.classList.remove("cheapest"); cell.querySelector(".mark")?.remove(); }
      const methods = cells.map(({ dataset }) => ({
        mae: numberIn(dataset.mae), cover: numberIn(dataset.cover), ms: numberIn(dataset.ms), interior: numberIn(dataset.interior),
      }));
      const best = cheapest(methods, { mae: numberIn(mae.value), cover: numberIn(cover.value) });
      if (best < 0) continue;
      ++served;
      if (methods[best].interior > 0) ++faulty;
      cells[best].classList.add("cheapest");
      cells[best].insertAdjacentHTML("afterbegin", '<span class="mark"><span aria-hidden="true">★ </span><span class="hidden">cheapest: </span></span>');
    }
    const scenes = (n) => `${n} ${n === 1 ? "scene" : "scenes"}`;
    found.textContent = `A star marks the cheapest method within these limits: ${served} of ${scenes(rows.length)} have one.` +
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
