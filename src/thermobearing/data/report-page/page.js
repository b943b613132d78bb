"use strict";
// Contents, colours and tables of a report. Without scripts the page can be read all the same.
(() => {
  const root = document.documentElement;
  const status = document.getElementById("status");

  // Light or dark: the system's wish, until the reader presses the button.
  const system = matchMedia("(prefers-color-scheme: dark)");
  const button = document.getElementById("theme");
  const KEPT = "thermobearing-theme";
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
  const remember = (value) => {
    try {
      localStorage.setItem(KEPT, value);
    } catch {
      // A browser that keeps nothing for files: the choice holds until the page is closed.
    }
  };
  const remembered = () => {
    try {
      return localStorage.getItem(KEPT);
    } catch {
      return null;
    }
  };
  const show = (theme) => {
    if (theme === "light" || theme === "dark") root.dataset.theme = theme;
    else delete root.dataset.theme;
    button.setAttribute("aria-pressed", String(isDark()));
    document.dispatchEvent(new Event("themechange"));
  };
  button.hidden = false;
  button.addEventListener("click", () => {
    const dark = !isDark();
    const theme = dark === system.matches ? "" : dark ? "dark" : "light";
    remember(theme);
    show(theme);
  });
  system.addEventListener("change", () => show(root.dataset.theme));
  show(remembered());

  // Contents: open beside the text, folded above it; the section that is read is marked.
  const details = document.querySelector(".contents details");
  const beside = matchMedia("(min-width: 64rem)");
  let printing = false; // paper is narrow, but shows the list
  const fold = () => {
    if (details) details.open = printing || beside.matches;
  };
  const onPaper = (now) => () => {
    printing = now;
    fold();
  };
  beside.addEventListener("change", fold);
  addEventListener("beforeprint", onPaper(true));
  addEventListener("afterprint", onPaper(false));
  fold();

  const links = [...document.querySelectorAll(".contents a")];
  const heads = links.map((link) => document.getElementById(link.hash.slice(1)));
  const mark = () => {
    const end = innerHeight + scrollY >= root.scrollHeight - 2;
    const seen = heads.filter((head) => head.getClientRects().length);
    const above = seen.filter((head) => head.getBoundingClientRect().top < 0.3 * innerHeight);
    const now = heads.indexOf((end && scrollY > 0 ? seen : above).at(-1) ?? heads[0]);
    links.forEach((link, place) => {
      if (place === now) link.setAttribute("aria-current", "true");
      else link.removeAttribute("aria-current");
    });
  };
  let waiting = false;
  const markSoon = () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      mark();
    });
  };
  if (links.length) {
    addEventListener("scroll", markSoon, { passive: true });
    addEventListener("resize", markSoon);
    mark();
  }

  // Tables: a click on a head sorts upwards, downwards, and then as it was.
  const NEXT = { none: "ascending", ascending: "descending", descending: "none" };
  const keyOf = (row, column) => {
    const cell = row.cells[column];
    const text = cell.dataset.value ?? cell.textContent.trim();
    const number = cell.dataset.value === undefined ? NaN : Number(text);
    return { text, number, empty: text === "" };
  };
  const compare = (one, other, sign) => {
    if (one.empty || other.empty) return Number(one.empty) - Number(other.empty);
    const numbers = [one.number, other.number].map(Number.isNaN);
    if (numbers[0] !== numbers[1]) return Number(numbers[0]) - Number(numbers[1]);
    if (!numbers[0]) return sign * (one.number - other.number);
    return sign * one.text.localeCompare(other.text, undefined, { numeric: true });
  };
  const sort = (table, head) => {
    const order = NEXT[head.getAttribute("aria-sort") ?? "none"];
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    if (order !== "none") head.setAttribute("aria-sort", order);
    const body = table.tBodies[0];
    const sign = order === "descending" ? -1 : 1;
    const rows = [...body.rows].sort((a, b) => {
      const before = Number(a.dataset.row) - Number(b.dataset.row);
      if (order === "none") return before;
      return compare(keyOf(a, head.cellIndex), keyOf(b, head.cellIndex), sign) || before;
    });
    body.append(...rows);
    const name = head.textContent.trim();
    status.textContent = order === "none" ? "Rows as they were" : `Sorted by ${name}, ${order}`;
  };
  for (const table of document.querySelectorAll("table")) {
    [...table.tBodies[0].rows].forEach((row, place) => {
      row.dataset.row = String(place);
    });
    for (const press of table.querySelectorAll("thead button"))
      press.addEventListener("click", () => sort(table, press.closest("th")));
  }
})();
