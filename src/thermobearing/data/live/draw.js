// Charts drawn by hand: on a canvas for the screen, with the same calls into SVG for a file.
// And tables of texts.

/** @typedef {{x: ArrayLike<number>, y: ArrayLike<number>, colour: string, dash?: number[],
 *    width?: number, name?: string, points?: boolean}} Line */
/** @typedef {{lines: Line[], x: string, y: string, xrange?: [number, number],
 *    yrange?: [number, number], note?: string, mark?: number,
 *    bands?: {part: string, low: number, high: number, name: string}[]}} Spec */

const FONT = 'system-ui, "Segoe UI", Roboto, "Noto Sans", "Noto Sans CJK JP", Arial, sans-serif';

/** Number in few digits, with a true minus sign. */
export function short(value, digits = 3) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size >= 10 ** digits ? value.toFixed(0) : String(Number(value.toPrecision(digits)));
  return text.replace("-", "−");
}

/** Number in so many digits, also where they are zeros: for tables. */
export function fixed(value, digits = 3) {
  const plain = Math.abs(value) < 10 ** digits && Math.abs(value) >= 1e-3;
  return plain ? value.toPrecision(digits).replace("-", "−") : short(value, digits);
}

/** Put words into a part of the page, with K_eq and the like as symbols with an index. */
export function put(part, words) {
  part.replaceChildren(...words.split(/(?<![\w.])([A-Za-zα]_\w{1,2})\b/).map((piece, at) => {
    if (at % 2 === 0) return piece;
    const [whole, index] = [document.createElement("span"), document.createElement("sub")];
    index.textContent = piece.slice(2);
    whole.append(piece[0], index);
    return whole;
  }));
}

/** Round values in a range, and their words. @param {number[]} range @param {number} most @returns {[number, string][]} */
function ticks([low, high], most) {
  const raw = (high - low) / Math.max(most, 2);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5, 10].find((factor) => factor * power >= 0.999 * raw) ?? 10);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  /** @type {[number, string][]} */
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++)
    found.push([k * step, (k * step).toFixed(digits).replace("-", "−").replace(/^−(0\.?0*)$/, "$1")]);
  return found;
}

/** Lowest and highest of some arrays, with some room. */
function extent(arrays) {
  let low = Infinity;
  let high = -Infinity;
  for (const values of arrays)
    for (let k = 0; k < values.length; k++) {
      const value = values[k];
      if (value < low) low = value;
      if (value > high) high = value;
    }
  if (!(low <= high)) return [0, 1];
  const room = 0.05 * (high - low || Math.abs(high) || 1);
  return [low - room, high + room];
}

/** The few calls of a canvas that a drawing needs, written as SVG. */
class SvgPen {
  fillStyle = "#000";
  strokeStyle = "#000";
  lineWidth = 1;
  font = "12px";
  textAlign = "left";
  textBaseline = "alphabetic";
  constructor(width, height) {
    this.size = [width, height];
    this.parts = [];
    this.path = "";
    this.turned = "";
    this.dash = [];
  }
  beginPath() { this.path = ""; }
  moveTo(x, y) { this.path += `M${x.toFixed(2)} ${y.toFixed(2)}`; }
  lineTo(x, y) { this.path += `L${x.toFixed(2)} ${y.toFixed(2)}`; }
  setLineDash(dash) { this.dash = dash; }
  stroke() {
    const dash = this.dash.length ? ` stroke-dasharray="${this.dash.join(" ")}"` : "";
    const look = `stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}"${dash}`;
    this.parts.push(`<path d="${this.path}" fill="none" stroke-linejoin="round" ${look}/>`);
  }
  fillRect(x, y, w, h) {
    const box = `x="${x}" y="${y}" width="${w}" height="${h}"`;
    this.parts.push(`<rect ${box} fill="${this.fillStyle}"/>`);
  }
  strokeRect(x, y, w, h) {
    const box = `x="${x}" y="${y}" width="${w}" height="${h}" fill="none"`;
    this.parts.push(`<rect ${box} stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}"/>`);
  }
  fillText(words, x, y) {
    const anchor = { left: "start", center: "middle", right: "end" }[this.textAlign];
    const shift = { middle: "0.35em", top: "0.8em", alphabetic: "0" }[this.textBaseline];
    const size = this.font.match(/\d+(\.\d+)?px/)?.[0] ?? "12px";
    const safe = words.replace(/&/g, "&amp;").replace(/</g, "&lt;");
    const look = `text-anchor="${anchor}" font-size="${size}" fill="${this.fillStyle}"`;
    const place = this.turned || `x="${x}" y="${y}"`;
    this.parts.push(`<text ${place} dy="${shift}" ${look}>${safe}</text>`);
  }
  turnedText(words, x, y) {
    this.turned = `transform="translate(${x} ${y}) rotate(-90)"`;
    this.fillText(words, 0, 0);
    this.turned = "";
  }
  measureText(words) { return { width: 6.6 * words.length }; }
  text() {
    const [width, height] = this.size;
    const font = FONT.replaceAll('"', "'");
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" ` +
      `viewBox="0 0 ${width} ${height}" font-family="${font}">${this.parts.join("")}</svg>`;
  }
}

function turnedText(pen, words, x, y) {
  if (pen.turnedText) return pen.turnedText(words, x, y);
  pen.save();
  pen.translate(x, y);
  pen.rotate(-Math.PI / 2);
  pen.fillText(words, 0, 0);
  pen.restore();
}

/** Colours of the page now, or those of light paper. */
export function palette(light = false) {
  const dark = !light && getComputedStyle(document.documentElement).colorScheme.includes("dark") &&
    (document.documentElement.dataset.theme === "dark" ||
      (!document.documentElement.dataset.theme && matchMedia("(prefers-color-scheme: dark)").matches));
  // Blue and vermilion of Okabe and Ito, which the colour-blind tell apart; one of them is dashed.
  return dark
    ? { paper: "#14171b", ink: "#e6e8eb", quiet: "#a9b1ba", line: "#3b424b", cold: "#56b4e9",
        warm: "#f5a15f", third: "#cfcf5a" }
    : { paper: "#ffffff", ink: "#1a1a1a", quiet: "#51585f", line: "#d5d9de", cold: "#0072b2",
        warm: "#c14f00", third: "#6f6a00" };
}

/** A colour for each temperature: lightness grows with it, also for the colour-blind. */
const HEAT = [[13, 8, 135], [106, 0, 168], [177, 42, 144], [225, 100, 98], [252, 166, 54], [240, 249, 33]];
export function heat(value, [low, high]) {
  const place = Math.min(Math.max((value - low) / (high - low || 1), 0), 1) * (HEAT.length - 1);
  const k = Math.min(Math.floor(place), HEAT.length - 2);
  const mixed = HEAT[k].map((c, at) => Math.round(c + (place - k) * (HEAT[k + 1][at] - c)));
  return `rgb(${mixed.join(",")})`;
}

/** Draw lines in a frame with axes. Lines longer than the frame is wide are thinned. */
export function drawLines(pen, [width, height], spec, colours) {
  const small = width < 480;
  const size = small ? 11 : 12.5;
  pen.font = `${size}px ${FONT}`;
  pen.fillStyle = colours.paper;
  pen.fillRect(0, 0, width, height);
  const [left, right, bottom] = [58, 12, 42];
  // The legend in as many rows as its words need.
  const legend = [];
  let [across, row] = [0, 0];
  for (const line of spec.lines.filter((one) => one.name)) {
    const room = 44 + pen.measureText(line.name).width;
    if (across && across + room > width - left) [across, row] = [0, row + 1];
    legend.push([line, left + across, 10 + 18 * row]);
    across += room;
  }
  // Then the names of the bands, each once, with a box in its colour.
  const bands = spec.bands ?? [];
  const tint = { rubber: colours.line, steel: colours.paper };
  const boxes = [];
  for (const band of bands.filter(({ part }, at) => bands.findIndex((one) => one.part === part) === at)) {
    const room = 44 + pen.measureText(band.name).width;
    if (across && across + room > width - left) [across, row] = [0, row + 1];
    boxes.push([band, left + across, 10 + 18 * row]);
    across += room;
  }
  const top = 8 + (legend.length ? (row + 1) * 18 : 0);
  const box = { x: left, y: top, w: width - left - right, h: height - top - bottom };
  const xr = spec.xrange ?? extent(spec.lines.map((line) => line.x));
  const yr = spec.yrange ?? extent(spec.lines.map((line) => line.y));
  const px = (value) => box.x + ((value - xr[0]) / (xr[1] - xr[0])) * box.w;
  const py = (value) => box.y + box.h - ((value - yr[0]) / (yr[1] - yr[0])) * box.h;
  for (const { part, low, high } of bands) {
    pen.fillStyle = tint[part];
    pen.fillRect(box.x, py(high), box.w, py(low) - py(high));
  }
  pen.lineWidth = 0.7;
  pen.strokeStyle = colours.line;
  pen.fillStyle = colours.ink;
  pen.setLineDash([]);
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const [value, words] of ticks(xr, box.w / (small ? 60 : 85))) {
    pen.beginPath();
    pen.moveTo(px(value), box.y);
    pen.lineTo(px(value), box.y + box.h);
    pen.stroke();
    pen.fillText(words, px(value), box.y + box.h + 5);
  }
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const [value, words] of ticks(yr, box.h / 45)) {
    pen.beginPath();
    pen.moveTo(box.x, py(value));
    pen.lineTo(box.x + box.w, py(value));
    pen.stroke();
    pen.fillText(words, box.x - 6, py(value));
  }
  pen.textAlign = "center";
  pen.fillText(spec.x, box.x + box.w / 2, height - 9);
  turnedText(pen, spec.y, 11, box.y + box.h / 2);
  for (const line of spec.lines) {
    pen.strokeStyle = line.colour;
    pen.fillStyle = line.colour;
    pen.lineWidth = line.width ?? 1.8;
    pen.setLineDash(line.dash ?? []);
    if (line.points) {
      for (let k = 0; k < line.x.length; k++) pen.fillRect(px(line.x[k]) - 3.5, py(line.y[k]) - 3.5, 7, 7);
      continue;
    }
    pen.beginPath();
    let [lastX, lastY] = [NaN, NaN];
    for (let k = 0; k < line.x.length; k++) {
      const [x, y] = [px(line.x[k]), py(line.y[k])];
      if (Math.abs(x - lastX) + Math.abs(y - lastY) < 0.7 && k < line.x.length - 1) continue;
      if (k) pen.lineTo(x, y);
      else pen.moveTo(x, y);
      [lastX, lastY] = [x, y];
    }
    pen.stroke();
  }
  pen.setLineDash([]);
  if (spec.mark !== undefined) {
    pen.strokeStyle = colours.ink;
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(px(spec.mark), box.y);
    pen.lineTo(px(spec.mark), box.y + box.h);
    pen.stroke();
  }
  pen.lineWidth = 0.8;
  pen.strokeStyle = colours.quiet;
  pen.strokeRect(box.x, box.y, box.w, box.h);
  pen.textAlign = "left";
  for (const [line, x, y] of legend) {
    pen.strokeStyle = line.colour;
    pen.lineWidth = line.width ?? 1.8;
    pen.setLineDash(line.dash ?? []);
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x + 22, y);
    pen.stroke();
    pen.setLineDash([]);
    pen.fillStyle = colours.ink;
    pen.fillText(line.name, x + 28, y);
  }
  pen.lineWidth = 0.8;
  pen.strokeStyle = colours.quiet;
  for (const [{ part, name }, x, y] of boxes) {
    pen.fillStyle = tint[part];
    pen.fillRect(x, y - 6, 22, 12);
    pen.strokeRect(x, y - 6, 22, 12);
    pen.fillStyle = colours.ink;
    pen.fillText(name, x + 28, y);
  }
}

/** Rubber layers and the steel between them, from the top: depth, thickness and temperature in the middle. */
export function partsOf(cells) {
  /** @type {{part: string, depth: number, thickness: number, temperatures: number[]}[]} */
  const parts = [];
  let depth = 0;
  for (const { material, thickness, temperature } of cells) {
    const part = material === "rubber" ? "rubber" : "steel";
    let last = parts.at(-1);
    if (last?.part !== part) parts.push(last = { part, depth, thickness: 0, temperatures: [] });
    last.thickness += thickness;
    last.temperatures.push(temperature);
    depth += thickness;
  }
  return parts.map(({ temperatures, ...one }) => ({ ...one, temperature: temperatures[temperatures.length >> 1] }));
}

/** Draw the stack of a bearing to scale, its parts in the colours of their temperatures.
 * `cells`: [{material, thickness, temperature}] from the top; `scale`: [lowest, highest]. */
export function drawStack(pen, [width, height], spec, colours) {
  pen.font = `12px ${FONT}`;
  pen.fillStyle = colours.paper;
  pen.fillRect(0, 0, width, height);
  const total = spec.cells.reduce((sum, cell) => sum + cell.thickness, 0);
  const [low, high] = spec.scale;
  const bar = 64; // room for the scale of colours
  const factor = Math.min((width - bar - 16) / spec.breadth, (height - 44) / total);
  const middle = (width - bar) / 2;
  const start = (height - 28 - factor * total) / 2 + 6;
  let y = start;
  for (const cell of spec.cells) {
    const h = factor * cell.thickness;
    const w = factor * spec.breadth;
    pen.fillStyle = heat(cell.temperature, spec.scale);
    pen.fillRect(middle - w / 2, y, w, h + 0.4);
    if (cell.material !== "rubber") {
      // Steel is paler and has edges, so that the parts are seen in any colour.
      pen.fillStyle = "rgba(255,255,255,0.25)";
      pen.fillRect(middle - w / 2, y, w, h);
      pen.fillStyle = colours.quiet;
      pen.fillRect(middle - w / 2 - 3, y, 3, h + 0.4);
      pen.fillRect(middle + w / 2, y, 3, h + 0.4);
    }
    y += h;
  }
  // The first part of each kind that is thick enough for it has its name.
  pen.textAlign = "left";
  pen.textBaseline = "middle";
  for (const kind of ["rubber", "steel"]) {
    const roomy = partsOf(spec.cells).find((one) => one.part === kind && factor * one.thickness >= 13);
    if (!roomy) continue;
    pen.fillStyle = roomy.temperature > (low + high) / 2 ? "#000" : "#fff";
    pen.fillText(spec.names[kind], middle - (factor * spec.breadth) / 2 + 8, start + factor * (roomy.depth + roomy.thickness / 2));
  }
  if (spec.lead) {
    const across = spec.lead.inPlan;
    const d = factor * spec.lead.diameter;
    for (let k = 0; k < across; k++) {
      const x = middle + ((k + 0.5) / across - 0.5) * factor * spec.breadth;
      pen.fillStyle = heat(spec.lead.temperature, spec.scale);
      pen.fillRect(x - d / 2, start + factor * spec.lead.cover, d, factor * (total - 2 * spec.lead.cover));
      pen.strokeStyle = colours.paper;
      pen.lineWidth = 1.2;
      pen.strokeRect(x - d / 2, start + factor * spec.lead.cover, d, factor * (total - 2 * spec.lead.cover));
      pen.fillStyle = spec.lead.temperature > (low + high) / 2 ? "#000" : "#fff";
      pen.textAlign = "center";
      pen.textBaseline = "middle";
      const words = `${short(spec.lead.temperature)} °C`;
      if (pen.measureText(words).width < d) pen.fillText(words, x, start + (factor * total) / 2);
    }
  }
  const x = width - bar + 4;
  const steps = 40;
  for (let k = 0; k < steps; k++) {
    pen.fillStyle = heat(high - ((k + 0.5) / steps) * (high - low), spec.scale);
    pen.fillRect(x, 18 + (k * (height - 60)) / steps, 12, (height - 60) / steps + 0.5);
  }
  pen.fillStyle = colours.ink;
  pen.textAlign = "left";
  pen.textBaseline = "middle";
  for (const [value, words] of ticks([low, high], 6))
    pen.fillText(words, x + 17, 18 + ((high - value) / (high - low || 1)) * (height - 60));
  pen.fillText("°C", x, 8);
  // A length to compare with.
  const raw = spec.breadth / 3;
  const length = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000].findLast((one) => one <= raw) ?? raw;
  pen.fillRect(10, height - 12, factor * length, 2);
  pen.fillText(`${length} mm`, 14 + factor * length, height - 11);
}

/** A canvas that draws again when its size or the theme changes, and saves itself as a file. */
export class Chart {
  constructor(canvas, draw) {
    this.canvas = canvas;
    this.draw = draw;
    this.spec = null;
    new ResizeObserver(() => this.again()).observe(canvas);
  }
  show(make) {
    this.make = make;
    this.again();
  }
  again(light = false) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!this.make || !width) return;
    const ratio = Math.min(devicePixelRatio || 1, 2);
    if (this.canvas.width !== Math.round(width * ratio)) this.canvas.width = Math.round(width * ratio);
    if (this.canvas.height !== Math.round(height * ratio)) this.canvas.height = Math.round(height * ratio);
    const pen = this.canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.lineJoin = "round";
    const colours = palette(light);
    this.draw(pen, [width, height], this.make(colours), colours);
  }
  svg() {
    const size = /** @type {[number, number]} */ ([760, 460]);
    const pen = new SvgPen(...size);
    const colours = palette(true);
    this.draw(pen, size, this.make(colours), colours);
    return pen.text();
  }
  /** @returns {Promise<Blob>} */
  png() {
    const canvas = document.createElement("canvas");
    canvas.width = 1520;
    canvas.height = 920;
    const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    pen.scale(2, 2);
    const colours = palette(true);
    this.draw(pen, [760, 460], this.make(colours), colours);
    return new Promise((done) => canvas.toBlob((blob) => done(blob ?? new Blob()), "image/png"));
  }
}

const isAmount = (words) => /^[\d−–.(]/.test(words);
/** Fill a table with heads and rows of texts; the first of a row is its head. */
export function fillTable(table, heads, rows) {
  const head = document.createElement("thead");
  const body = document.createElement("tbody");
  const line = document.createElement("tr");
  for (const [at, words] of heads.entries()) {
    const cell = document.createElement("th");
    cell.scope = "col";
    if (at && (!rows.length || isAmount(rows[0][at]))) cell.className = "amount";
    put(cell, words);
    line.append(cell);
  }
  head.append(line);
  for (const row of rows) {
    const tr = document.createElement("tr");
    for (const [at, words] of row.entries()) {
      const cell = document.createElement(at ? "td" : "th");
      if (!at) cell.scope = "row";
      else if (isAmount(words)) cell.className = "amount";
      put(cell, words);
      tr.append(cell);
    }
    body.append(tr);
  }
  table.replaceChildren(head, body);
}

/** Mark the boxes whose table is broader than they are, now and after each change of a size. */
export function watchBroadTables() {
  const observer = new ResizeObserver(() => {
    for (const box of document.querySelectorAll(".scroll")) box.classList.toggle("broad", box.scrollWidth > box.clientWidth + 1);
  });
  for (const part of document.querySelectorAll(".scroll, .scroll > table")) observer.observe(part);
}
