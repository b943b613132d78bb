// What is wider than its column scrolls by itself; a keyboard must reach it to do so.
const WIDE = "table.table, div.math, mjx-container";

function reachable() {
  for (const part of document.querySelectorAll(WIDE)) {
    if (part.scrollWidth > part.clientWidth) part.tabIndex = 0;
    else part.removeAttribute("tabindex");
  }
}

// Equations have their width once they are set.
window.addEventListener("load", () => {
  const set = window.MathJax?.startup?.promise ?? Promise.resolve();
  set.then(reachable);
});
window.addEventListener("resize", reachable);
