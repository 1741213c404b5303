// How pictures are drawn: smooth where they are scaled down, in crisp pixels where they are scaled up.
"use strict";

const sizes = new ResizeObserver((entries) => { for (const { target } of entries) sharpen(target); });
function sharpen(image) {
  const width = Number(image.getAttribute("width")) || image.naturalWidth;
  image.classList.toggle("pixels", width > 0 && image.clientWidth * devicePixelRatio > width);
}
for (const image of document.querySelectorAll("figure img")) {
  sizes.observe(image);
  image.addEventListener("load", () => sharpen(image));
}
// Pictures that nobody has scrolled to are loaded after the rest of the page: paper shows them all.
addEventListener("load", () => document.querySelectorAll("img[loading]").forEach((image) => { image.loading = "eager"; }));
