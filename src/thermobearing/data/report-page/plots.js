"use strict";
// The plots of a report: lines from their data, a menu, a slider; light, dark and on paper.
(() => {
  const PRINTED = 660; // width on paper [px]: that of the text on A4
  const HEIGHT = 420;
  const HEIGHT_PRINTED = 360; // two on a page
  const BROAD = 640; // above this width equal axes get more height
  const root = document.documentElement;
  const system = matchMedia("(prefers-color-scheme: dark)");
  const paper = matchMedia("print");
  let printing = false;

  const isDark = () => {
    if (printing) return false;
    return root.dataset.theme ? root.dataset.theme === "dark" : system.matches;
  };
  const colours = () => {
    const style = getComputedStyle(root);
    const side = isDark() ? "dark" : "light";
    const of = (name) => style.getPropertyValue(`--${name}-${side}`).trim();
    return { paper: of("paper"), ink: of("ink"), line: of("line"), dark: isDark() };
  };

  // Plotly reads some tags in its words: none of ours are meant so.
  const plain = (words) =>
    words.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");

  // A dark line on dark paper is made lighter until it can be seen.
  const parts = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
  const light = (rgb) => {
    const [r, g, b] = rgb.map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const seen = (hex, look) => {
    if (!look.dark || !/^#[0-9a-f]{6}$/i.test(hex)) return hex;
    const ground = light(parts(look.paper)) + 0.05;
    let rgb = parts(hex);
    while ((light(rgb) + 0.05) / ground < 4.5) rgb = rgb.map((c) => c + 0.1 * (1 - c));
    return `rgb(${rgb.map((c) => Math.round(255 * c)).join(",")})`;
  };

  const floats = (text) =>
    new Float32Array(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);

  // Lowest and highest of many numbers, without what is not one.
  const span = (arrays) => {
    let low = Infinity;
    let high = -Infinity;
    for (const values of arrays)
      for (const value of values) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
    return low <= high ? [low, high] : [0, 1];
  };
  const roomy = ([low, high]) => {
    const room = 0.05 * (high - low || Math.abs(high) || 1);
    return [low - room, high + room];
  };

  class Picture {
    constructor(figure) {
      this.div = figure.querySelector(".plot");
      this.menu = figure.querySelector("select");
      this.slider = figure.querySelector("input[type=range]");
      this.output = figure.querySelector("output");
      this.printed = figure.querySelector(".print-only");
      this.data = JSON.parse(figure.querySelector("script").textContent);
      this.arrays = this.data.arrays.map(() => null);
      this.drawn = false;
      this.menu?.addEventListener("change", () => this.draw());
      this.slider?.addEventListener("input", () => this.slide());
      this.tell();
    }

    array(place) {
      this.arrays[place] ??= floats(this.data.arrays[place]);
      return this.arrays[place];
    }

    get traces() {
      return this.data.choices[this.menu ? this.menu.selectedIndex : 0];
    }

    get place() {
      return this.slider ? Number(this.slider.value) : 0;
    }

    // Of a trace with frames: the numbers of the place where the slider stands.
    values(trace, axis) {
      const frames = trace[`frames_${axis}`];
      if (frames === null) return this.array(trace[axis]);
      const all = this.array(frames);
      const points = all.length / this.data.slider.length;
      return all.subarray(this.place * points, (this.place + 1) * points);
    }

    // All numbers that an axis has to hold wherever the slider stands.
    extent(axis) {
      return span(this.traces.map((t) => this.array(t[`frames_${axis}`] ?? t[axis])));
    }

    tell() {
      const words = [];
      if (this.menu) words.push(this.menu.selectedOptions[0].textContent);
      if (this.slider) {
        const now = this.data.slider[this.place];
        this.output.textContent = now;
        this.slider.setAttribute("aria-valuetext", now);
        words.push(`${this.data.slider_title} ${now}`.trim());
      }
      if (this.printed) this.printed.textContent = words.join(", ");
    }

    lines(look) {
      const named = new Set();
      return this.traces.map((trace) => {
        const first = trace.name !== "" && !named.has(trace.name);
        named.add(trace.name);
        const colour = seen(trace.colour, look);
        const marks = trace.look.includes("points");
        return {
          type: "scatter",
          mode: { line: "lines", dashed: "lines", points: "markers" }[trace.look] ?? "lines+markers",
          x: this.values(trace, "x"),
          y: this.values(trace, "y"),
          name: plain(trace.name),
          legendgroup: trace.name,
          showlegend: first,
          hoverlabel: { namelength: -1 },
          line: { color: colour, width: 1.6, dash: trace.look === "dashed" ? "dash" : "solid" },
          marker: { color: colour, size: marks ? 6 : 0 },
        };
      });
    }

    // Shaded where it was not tested, as far as the lines go.
    shades(range, look) {
      const found = [];
      for (const [from, to] of this.data.bands) {
        const x0 = Math.max(from ?? -Infinity, range[0]);
        const x1 = Math.min(to ?? Infinity, range[1]);
        if (x0 >= x1) continue;
        const whole = { yref: "paper", y0: 0, y1: 1, layer: "below" };
        const edge = { color: look.dark ? "#ff9a8d" : "#a33", width: 1, dash: "dot" };
        const fill = look.dark ? "rgba(255,120,100,0.16)" : "rgba(204,51,17,0.12)";
        found.push({ type: "rect", x0, x1, ...whole, fillcolor: fill, line: { width: 0 } });
        for (const x of [x0, x1].filter((x) => range[0] < x && x < range[1]))
          found.push({ type: "line", x0: x, x1: x, ...whole, line: edge });
      }
      return found;
    }

    layout(look) {
      const axis = (title) => ({
        title: { text: plain(title), standoff: 8 },
        gridcolor: look.line,
        zerolinecolor: look.line,
        linecolor: look.line,
        showline: true,
        automargin: true,
        hoverformat: ".4g",
        exponentformat: "power",
        minexponent: 5,
      });
      const x = axis(this.data.x_title);
      const y = axis(this.data.y_title);
      const reach = roomy(this.extent("x"));
      if (this.data.bands.length || this.slider) x.range = reach;
      if (this.slider) y.range = roomy(this.extent("y"));
      if (this.data.equal) Object.assign(y, { scaleanchor: "x", constrain: "domain" });
      if (this.data.equal) x.constrain = "domain";
      const names = new Set(this.traces.map((trace) => trace.name)).size;
      const height = printing ? HEIGHT_PRINTED : HEIGHT;
      const width = printing ? PRINTED : this.div.clientWidth;
      return {
        width,
        height: this.data.equal ? Math.min(Math.max(width, 320), BROAD) : height,
        margin: { l: 60, r: 16, t: 16, b: 50 },
        paper_bgcolor: look.paper,
        plot_bgcolor: look.paper,
        font: { family: getComputedStyle(document.body).fontFamily, size: 13, color: look.ink },
        hovermode: "closest",
        hoverlabel: { bgcolor: look.paper, bordercolor: look.line, font: { color: look.ink } },
        showlegend: names > 1,
        legend: { orientation: "h", x: 0, y: 1.01, yanchor: "bottom" },
        modebar: { bgcolor: "rgba(0,0,0,0)", color: look.ink, activecolor: look.ink },
        separators: ".\u202f",
        shapes: this.shades(reach, look),
        xaxis: x,
        yaxis: y,
      };
    }

    draw() {
      this.tell();
      this.drawn = true;
      const look = colours();
      Plotly.react(this.div, this.lines(look), this.layout(look), {
        displaylogo: false,
        modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"],
        toImageButtonOptions: { format: "svg", filename: this.div.id },
      });
    }

    slide() {
      this.tell();
      const moving = this.traces.map((t, place) => [t, place]);
      const lines = moving.filter(([t]) => t.frames_y !== null || t.frames_x !== null);
      const change = {
        x: lines.map(([t]) => this.values(t, "x")),
        y: lines.map(([t]) => this.values(t, "y")),
      };
      Plotly.restyle(this.div, change, lines.map(([, place]) => place));
    }
  }

  const pictures = [...document.querySelectorAll("figure.has-plot")].map((f) => new Picture(f));
  const redraw = () => {
    for (const picture of pictures) if (picture.drawn || printing) picture.draw();
  };
  // Drawn when they come near, so that a report of many opens at once.
  const watch = new IntersectionObserver(
    (entries) => {
      for (const entry of entries) {
        const picture = pictures.find((p) => p.div === entry.target);
        if (entry.isIntersecting && !picture.drawn) picture.draw();
      }
    },
    { rootMargin: "800px" },
  );
  for (const picture of pictures) watch.observe(picture.div);

  const print = (now) => {
    if (printing === now) return;
    printing = now;
    redraw();
  };
  addEventListener("beforeprint", () => print(true));
  addEventListener("afterprint", () => print(false));
  paper.addEventListener("change", () => print(paper.matches));
  document.addEventListener("themechange", redraw);
  let width = innerWidth;
  addEventListener("resize", () => {
    if (innerWidth !== width && !printing) redraw();
    width = innerWidth;
  });
})();
