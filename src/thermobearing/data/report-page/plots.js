"use strict";
// The plots of a report as SVG: lines from their data, a menu, a slider, zoom, values at a point.
(() => {
  const HEIGHT = 420;
  const BROAD = 640; // above this width equal axes get no more height
  const NEAR = 40; // distance of the pointer from a point whose values are shown [px]
  const LETTER = 7.2; // width of a letter of a tick label [px]
  const AXES = ["x", "y"];
  const LINES = { dashed: "line dashed", broad: "line broad" }; // classes by the look of a trace
  const KEPT = ["fill", "stroke", "stroke-width", "stroke-dasharray", "stroke-linecap", "font"];
  const status = document.getElementById("status");

  const add = (parent, name, attributes = {}, words = "") => {
    const svg = name === "svg" || parent instanceof SVGElement;
    const space = svg ? "http://www.w3.org/2000/svg" : "http://www.w3.org/1999/xhtml";
    const part = document.createElementNS(space, name);
    for (const [key, value] of Object.entries(attributes)) part.setAttribute(key, value);
    if (words) part.textContent = words;
    parent.append(part);
    return part;
  };

  // A dark line is lighter on dark paper.
  const ink = (hex) => `light-dark(${hex}, oklch(from ${hex} max(l, 0.72) c h))`;
  const plain = (text) => text.replace(/\.?0+(?=e|$)/, "").replace("e+", "e").replaceAll("-", "−");
  const number = (value) => {
    const size = Math.abs(value);
    if (size !== 0 && (size >= 1e6 || size < 1e-4)) return plain(value.toExponential(3));
    const text = size >= 1000 ? value.toFixed(0) : value.toPrecision(4);
    return text.includes(".") ? plain(text) : text.replace("-", "−");
  };
  // About so many round values in a range, and their words.
  const ticks = ([low, high], most) => {
    const raw = (high - low) / Math.max(most, 3);
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = power * [1, 2, 5, 10].find((factor) => factor * power >= 0.999 * raw);
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const large = Math.max(Math.abs(low), Math.abs(high)) >= 1e6 || digits > 5;
    const found = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) {
      const text = large ? plain((k * step).toExponential(3)) : (k * step).toFixed(digits);
      found.push([k * step, text.replace("-", "−")]);
    }
    return found;
  };
  const floats = (text) =>
    new Float32Array(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
  // Lowest and highest of many numbers, without what is not one, and some room beyond.
  const extent = (arrays) => {
    let [low, high] = [Infinity, -Infinity];
    for (const values of arrays)
      for (const value of values) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
    if (low > high) return [0, 1];
    const room = 0.05 * (high - low || Math.abs(high) || 1);
    return [low - room, high + room];
  };

  class Plot {
    constructor(figure) {
      const parts = [".plot", "select", "input", "output", ".print-only", "script"];
      [this.div, this.menu, this.slider, this.output, this.printed, this.data] = parts.map((part) =>
        figure.querySelector(part),
      );
      this.data = JSON.parse(this.data.textContent);
      this.arrays = this.data.arrays.map(() => null);
      this.hidden = new Set();
      this.menu?.addEventListener("change", () => this.start());
      this.slider?.addEventListener("input", () => (this.svg ? this.draw() : this.start()));
      this.tell();
    }

    array(place) {
      return (this.arrays[place] ??= floats(this.data.arrays[place]));
    }

    get traces() {
      return this.data.choices[this.menu ? this.menu.selectedIndex : 0];
    }

    get titles() {
      return this.data.titles[this.menu ? this.menu.selectedIndex : 0];
    }

    // Of a trace with frames: the numbers of the place where the slider stands.
    values(trace, axis) {
      const frames = trace[`frames_${axis}`];
      if (frames === null) return this.array(trace[axis]);
      const all = this.array(frames);
      const points = all.length / this.data.slider.length;
      return all.subarray(this.slider.value * points, (Number(this.slider.value) + 1) * points);
    }

    tell() {
      const words = [];
      if (this.menu) words.push(this.menu.selectedOptions[0].textContent);
      if (this.slider) {
        const now = this.data.slider[this.slider.value];
        this.output.textContent = now;
        this.slider.setAttribute("aria-valuetext", now);
        words.push(`${this.data.slider_title} ${now}`.trim());
      }
      if (this.printed) this.printed.textContent = words.join(", ");
    }

    // The legend, the buttons and the sheet: once for each choice of the menu.
    start() {
      this.div.replaceChildren();
      this.hidden.clear();
      this.whole();
      const bar = add(this.div, "div", { class: "plot-bar" });
      const legend = add(bar, "div", { class: "legend", role: "group", "aria-label": "Lines" });
      const names = new Map(this.traces.map((trace) => [trace.name, trace]));
      for (const [name, trace] of names.size > 1 ? names : []) {
        const button = add(legend, "button", { type: "button", "aria-pressed": "true" });
        const swatch = add(button, "span", { class: `swatch ${trace.look}` });
        swatch.style.color = ink(trace.colour);
        button.append(name);
        button.onclick = () => {
          if (!this.hidden.delete(name)) this.hidden.add(name);
          button.setAttribute("aria-pressed", String(!this.hidden.has(name)));
          this.draw();
        };
      }
      const tools = add(bar, "div", { class: "tools", role: "group", "aria-label": "View" });
      for (const [sign, label, act] of [
        ["+", "Zoom in", () => this.zoom(0.5)],
        ["−", "Zoom out", () => this.zoom(2)],
        ["⤢", "Whole plot", () => this.zoom(0)],
        ["⤓", "Save as SVG", () => this.save()],
      ]) {
        const look = { type: "button", "aria-label": label, title: label };
        add(tools, "button", look, sign).onclick = act;
      }
      const label = `${this.div.getAttribute("aria-label")} Arrow keys read the values.`;
      const look = { class: "sheet", tabindex: "0", role: "application", "aria-label": label };
      this.sheet = add(this.div, "div", look);
      this.bind();
      this.draw();
    }

    whole() {
      for (const axis of AXES)
        this[axis] = extent(this.traces.map((t) => this.array(t[`frames_${axis}`] ?? t[axis])));
    }

    zoom(factor) {
      const wider = ([low, high], end) => (low + high) / 2 + factor * (end - (low + high) / 2);
      if (factor === 0) this.whole();
      else for (const axis of AXES) this[axis] = this[axis].map((end) => wider(this[axis], end));
      this.draw();
    }

    // Where a value of an axis is on the sheet [px].
    at(axis, value) {
      const [low, high] = this[axis];
      const share = (value - low) / (high - low);
      return axis === "x" ? this.left + share * this.width : this.top + (1 - share) * this.height;
    }

    // The size of the panel on the sheet; with equal axes the shorter range grows.
    layOut() {
      const wide = Math.max(this.div.clientWidth, 240);
      this.total = this.data.equal ? Math.min(Math.max(wide, 320), BROAD) : HEIGHT;
      this.top = 10;
      this.height = this.total - this.top - 48;
      const labels = ticks(this.y, this.height / 50).map(([, text]) => text.length);
      this.left = 34 + LETTER * Math.max(1, ...labels);
      this.width = wide - this.left - 16;
      if (!this.data.equal) return;
      const scale = AXES.map((a) => (this[a][1] - this[a][0]) / (a === "x" ? this.width : this.height));
      AXES.forEach((axis, place) => {
        const more = (Math.max(...scale) / scale[place] - 1) * 0.5 * (this[axis][1] - this[axis][0]);
        this[axis] = [this[axis][0] - more, this[axis][1] + more];
      });
    }

    draw() {
      this.tell();
      this.layOut();
      this.svg?.remove();
      const wide = this.left + this.width + 16;
      const box = { viewBox: `0 0 ${wide} ${this.total}`, width: wide, height: this.total };
      this.svg = add(this.sheet, "svg", { ...box, class: "drawing", "aria-hidden": "true" });
      const clip = add(this.svg, "clipPath", { id: `${this.div.id}-panel` });
      const panel = { x: this.left, y: this.top, width: this.width, height: this.height };
      add(clip, "rect", panel);
      const inside = add(this.svg, "g", { "clip-path": `url(#${this.div.id}-panel)` });
      this.bands(inside);
      this.axes();
      add(this.svg, "rect", { ...panel, class: "frame" });
      this.div.data = this.traces.map((trace) => {
        const [x, y] = AXES.map((axis) => this.values(trace, axis));
        if (!this.hidden.has(trace.name)) this.line(inside, trace, x, y);
        return { name: trace.name, x, y };
      });
      inside.remove();
      this.svg.append(inside); // above the grid
      this.mark = add(this.svg, "circle", { class: "mark", r: 5, visibility: "hidden" });
    }

    // Shaded where it was not tested.
    bands(inside) {
      const [low, high] = this.x;
      for (const [from, to] of this.data.bands) {
        const [x0, x1] = [Math.max(from ?? -Infinity, low), Math.min(to ?? Infinity, high)];
        if (x0 >= x1) continue;
        const [x, end] = [x0, x1].map((value) => this.at("x", value));
        const box = { y: this.top, height: this.height, class: "band" };
        add(inside, "rect", { ...box, x, width: end - x });
      }
    }

    axes() {
      const [right, bottom] = [this.left + this.width, this.top + this.height];
      const center = { "text-anchor": "middle" };
      for (const [value, text] of ticks(this.x, this.width / 90)) {
        const x = this.at("x", value);
        add(this.svg, "path", { d: `M${x} ${this.top}V${bottom}`, class: "grid" });
        add(this.svg, "text", { x, y: bottom + 17, ...center }, text);
      }
      for (const [value, text] of ticks(this.y, this.height / 50)) {
        const y = this.at("y", value);
        add(this.svg, "path", { d: `M${this.left} ${y}H${right}`, class: "grid" });
        add(this.svg, "text", { x: this.left - 6, y: y + 4, "text-anchor": "end" }, text);
      }
      const below = `translate(${(this.left + right) / 2} ${bottom + 38})`;
      const beside = `translate(15 ${(this.top + bottom) / 2}) rotate(-90)`;
      const [across, up] = this.titles;
      for (const [transform, words] of [[below, across], [beside, up]])
        add(this.svg, "text", { ...center, class: "axis-title", transform }, words);
    }

    line(inside, trace, x, y) {
      const [steps, dots] = [[], []];
      let joined = false;
      for (let k = 0; k < x.length; k++) {
        const there = Number.isFinite(x[k]) && Number.isFinite(y[k]);
        if (there) {
          const point = `${this.at("x", x[k]).toFixed(1)} ${this.at("y", y[k]).toFixed(1)}`;
          steps.push(`${joined ? "L" : "M"}${point}`);
          dots.push(`M${point}h0`);
        }
        joined = there;
      }
      const draw = (look, path) => {
        add(inside, "path", { class: look, d: path.join("") }).style.stroke = ink(trace.colour);
      };
      if (trace.look !== "points") draw(LINES[trace.look] ?? "line", steps);
      if (trace.look.includes("points")) draw("points", dots);
    }

    // The nearest point to a place on the sheet.
    nearest(px, py) {
      let found = { distance: NEAR };
      this.div.data.forEach(({ name, x, y }, trace) => {
        if (this.hidden.has(name)) return;
        for (let k = 0; k < x.length; k++) {
          const distance = Math.hypot(this.at("x", x[k]) - px, this.at("y", y[k]) - py);
          if (distance < found.distance) found = { distance, trace, point: k };
        }
      });
      return found;
    }

    // The values of a point beside it; none where there is no point.
    point({ trace, point }, aloud = false) {
      this.label?.remove();
      this.mark.setAttribute("visibility", trace === undefined ? "hidden" : "visible");
      if (trace === undefined) return;
      this.now = { trace, point };
      const { name, x, y } = this.div.data[trace];
      const [px, py] = [this.at("x", x[point]), this.at("y", y[point])];
      this.mark.setAttribute("transform", `translate(${px} ${py})`);
      const [across, up] = this.titles;
      const values = [`${across}: ${number(x[point])}`, `${up}: ${number(y[point])}`];
      const words = [name, ...values].filter(Boolean);
      this.label = add(this.sheet, "div", { class: "values" }, words.join("\n"));
      this.label.style.top = `${Math.min(py + 12, this.total - 70)}px`;
      const side = px > this.left + this.width / 2 ? "right" : "left";
      const wide = this.left + this.width + 16;
      this.label.style[side] = `${(side === "left" ? px : wide - px) + 12}px`;
      if (aloud) status.textContent = words.join(", ");
    }

    bind() {
      const place = (event) => {
        const box = this.svg.getBoundingClientRect();
        return [event.clientX - box.left, event.clientY - box.top];
      };
      let [start, frame] = [null, null];
      this.sheet.onpointerdown = (event) => {
        if (event.pointerType === "touch" || event.button !== 0) return;
        start = place(event);
        this.sheet.setPointerCapture(event.pointerId);
        frame = add(this.svg, "rect", { class: "zoom" });
      };
      this.sheet.onpointermove = (event) => {
        const now = place(event);
        if (!start) return this.point(this.nearest(...now));
        for (const [at, [side, size]] of [["x", "width"], ["y", "height"]].entries()) {
          frame.setAttribute(side, Math.min(start[at], now[at]));
          frame.setAttribute(size, Math.abs(start[at] - now[at]));
        }
      };
      this.sheet.onpointerup = (event) => {
        if (!start) return;
        const ends = [start, place(event)];
        start = null;
        frame.remove();
        const moved = AXES.map((_, at) => Math.abs(ends[0][at] - ends[1][at]) > 8);
        AXES.forEach((axis, at) => {
          if (!moved[at]) return;
          const [zero, one] = [0, 1].map((value) => this.at(axis, value));
          this[axis] = ends.map((end) => (end[at] - zero) / (one - zero)).sort((a, b) => a - b);
        });
        if (moved.includes(true)) this.draw();
      };
      this.sheet.onpointerleave = this.sheet.onblur = () => this.point({});
      this.sheet.ondblclick = () => this.zoom(0);
      this.sheet.onkeydown = (event) => this.key(event);
    }

    // Arrows go from point to point and from line to line; + - 0 zoom, shift with arrows moves.
    key(event) {
      const zooms = { "+": 0.5, "-": 2, "0": 0 };
      const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
      const way = ways[event.key];
      if (!(event.key in zooms) && !way) return;
      event.preventDefault();
      if (!way) return this.zoom(zooms[event.key]);
      if (event.shiftKey) {
        const moves = AXES.map((axis, at) => 0.2 * way[at] * (this[axis][1] - this[axis][0]));
        AXES.forEach((axis, at) => (this[axis] = this[axis].map((end) => end + moves[at])));
        return this.draw();
      }
      const shown = (k) => !this.hidden.has(this.div.data[k].name);
      const lines = [...this.div.data.keys()].filter(shown);
      if (!lines.length) return;
      const { trace = lines[0], point = -1 } = this.now ?? {};
      const next = lines[(lines.indexOf(trace) - way[1] + lines.length) % lines.length];
      const { x, y } = this.div.data[next];
      const step = Math.max(1, Math.round(x.length / 200)) * (way[0] || 1);
      let k = way[0] ? point + step : Math.max(point, 0);
      while (k >= 0 && k < x.length && !Number.isFinite(x[k] + y[k])) k += Math.sign(step);
      if (k >= 0 && k < x.length) this.point({ trace: next, point: k }, true);
    }

    // The drawing as a file, in light colours, with the looks of the page written into it.
    save() {
      this.svg.style.colorScheme = "light";
      const copy = this.svg.cloneNode(true);
      const originals = this.svg.querySelectorAll("*");
      copy.querySelectorAll("*").forEach((part, at) => {
        const style = getComputedStyle(originals[at]);
        for (const key of KEPT) part.style.setProperty(key, style.getPropertyValue(key));
      });
      this.svg.style.colorScheme = "";
      const text = new XMLSerializer().serializeToString(copy);
      const href = `data:image/svg+xml,${encodeURIComponent(text)}`;
      const link = add(this.div, "a", { href, download: `${this.div.id}.svg` });
      link.click();
      link.remove();
    }
  }

  // Drawn when they come near, so that a report of many opens at once; all of them for paper.
  const plots = [...document.querySelectorAll("figure.has-plot")].map((f) => new Plot(f));
  const start = (plot) => plot.svg || plot.start();
  const near = (entries) => {
    for (const entry of entries)
      if (entry.isIntersecting) start(plots.find((plot) => plot.div === entry.target));
  };
  const watch = new IntersectionObserver(near, { rootMargin: "800px" });
  for (const plot of plots) watch.observe(plot.div);
  addEventListener("beforeprint", () => plots.forEach(start));
  matchMedia("print").addEventListener("change", () => plots.forEach(start));
  let width = innerWidth;
  addEventListener("resize", () => {
    const printing = matchMedia("print").matches;
    if (innerWidth !== width && !printing) for (const plot of plots) if (plot.svg) plot.draw();
    width = innerWidth;
  });
})();
