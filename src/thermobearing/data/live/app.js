// The live page: a state, what the engine computes from it, and the views that show it.
import { createEngine, unpacked } from "./engine.js";
import { Chart, drawLines, drawStack, fillTable, fixed, partsOf, put, short, watchBroadTables } from "./draw.js";

const MOST_CYCLES = 100; // and steps that are computed while a slider moves
const MOST_STEPS = 400_000;
const DT = 0.005; // the largest step of a test [s], as in Python
const el = (name) => /** @type {any} */ (document.getElementById(name));
const page = JSON.parse(el("page-data").textContent);
const WORDS = page.words;

let language = (navigator.language || "en").startsWith("ja") ? "ja" : "en";
/** Words of the catalogue in the language of the page; a number stays in one line with its unit. */
function t(key, values = {}) {
  const text = WORDS[key]?.[language] ?? key;
  return text.replace(/\{(\w+)\}/g, (whole, name) => values[name] ?? whole).replace(/(?<=\d) (?=[%°])/g, "\u00a0");
}

const state = {
  view: "test", base: page.start, ambient: -20, protocol: "cycles", ...page.defaults, wave: "sine",
  motion: "", changes: {},
};
const FIELDS = { // of the state; factor from the shown number to the number of the file
  strain: { path: "strain", factor: 0.01 }, frequency: { path: "frequency", factor: 1 },
  count: { path: "count", factor: 1, most: MOST_CYCLES }, reference: { path: "ambient", factor: 1 },
};
let engine = null;
let bearing = null; // as the engine knows it
let dropped = null; // a motion of the user
let runs = null; // {cold, warm} of the test
let shaken = null; // the same of the bridge
// Results at the reference temperature and those of the codes, by what they were computed from.
const MOST_KEPT = { test: 4, bridge: 2, codes: 100, fit: 20 };
const kept = { test: new Map(), bridge: new Map(), codes: new Map(), fit: new Map() };
const charts = {};

// The state in the address.

function readAddress() {
  for (const [key, value] of new URLSearchParams(location.hash.slice(1))) {
    if (key === "lang" && (value === "ja" || value === "en")) language = value;
    else if (key.startsWith("set.")) state.changes[key.slice(4)] = Number(value);
    else if (key in state && typeof state[key] === "number") {
      if (Number.isFinite(Number(value))) state[key] = Number(value);
    } else if (key in state && key !== "changes") state[key] = value;
  }
  if (!document.querySelector(`[data-view="${CSS.escape(state.view)}"]`)) state.view = "test";
  if (!engine.bearings.some((one) => one.name === state.base)) [state.base, state.changes] = [page.start, {}];
  if (!page.motions.includes(state.motion)) state.motion = page.motions[0] ?? "";
  if (!["sine", "triangle"].includes(state.wave)) state.wave = "sine";
  if (!["cycles", "table-3.4"].includes(state.protocol)) state.protocol = "cycles";
  for (const name of Object.keys(FIELDS)) if (refusal(name, String(state[name] / FIELDS[name].factor))) state[name] = page.defaults[name];
  state.ambient = Math.min(Math.max(state.ambient, -40), 40);
}

function address() {
  const words = new URLSearchParams({ lang: language });
  for (const [key, value] of Object.entries(state))
    if (key !== "changes" && value !== "") words.set(key, String(value));
  for (const [key, value] of Object.entries(state.changes)) words.set(`set.${key}`, String(value));
  return `#${words}`;
}

let addressLater = 0;
function keepAddress() {
  clearTimeout(addressLater);
  addressLater = setTimeout(() => history.replaceState(null, "", address()), 300);
}

// Refusals, in the words of `check`.

const g = (value) => {
  if (value !== 0 && (Math.abs(value) < 1e-4 || Math.abs(value) >= 1e6))
    return value.toExponential().replace(/e([+-])(\d)$/, "e$10$2");
  return String(Number(value.toPrecision(6)));
};
function allowed(range) {
  if (language === "en") return `must be ${range.allowed}`;
  const { low, high, low_open, high_open, integer, unit } = range;
  const ends = [];
  if (Number.isFinite(low)) ends.push(t(low_open ? "greater" : "at_least", { v: g(low) }));
  if (Number.isFinite(high)) ends.push(t(high_open ? "less" : "at_most", { v: g(high) }));
  return `${t("must_be")}${t(integer ? "an_integer" : "a_number")} ${ends.join(t("and"))} ${unit ?? ""}`;
}
function isOutside(value, { low, high, low_open, high_open, integer }) {
  if (!Number.isFinite(value) || (integer && !Number.isInteger(value))) return true;
  if (Number.isFinite(low) && (low_open ? value <= low : value < low)) return true;
  return Number.isFinite(high) && (high_open ? value >= high : value > high);
}
/** Why a text is no value of a field; "" if it is one. */
function refusal(name, text) {
  const { path, factor, most } = FIELDS[name];
  const range = page.fields[path];
  const value = Number((Number(text.replace(",", ".")) * factor).toPrecision(12));
  if (text.trim() === "" || !Number.isFinite(value)) return `${path} = '${text}': ${allowed(range)}`;
  if (isOutside(value, range)) return `${path} = ${g(value)}: ${allowed(range)}`;
  if (most && value > most) return t("most_cycles", { key: path, value: g(value), most });
  return "";
}
function mark(input, problem) {
  el(`${input.id}-error`).textContent = problem;
  if (problem) input.setAttribute("aria-invalid", "true");
  else input.removeAttribute("aria-invalid");
}

// Computing.

const testOfState = () => state.protocol === "cycles"
  ? { strain: state.strain, cycles: state.count, wave: state.wave, frequency_hz: state.frequency }
  : { steps: stepsOfProtocol() };
const stepsOfProtocol = () => page.protocols[state.protocol].map((step) => ("cycles" in step ? { ...step, wave: state.wave } : step));

function once(kind, key, compute) {
  const name = JSON.stringify([state.base, state.changes, key]);
  const known = kept[kind];
  if (!known.has(name)) {
    if (known.size >= MOST_KEPT[kind]) known.delete(known.keys().next().value);
    known.set(name, compute());
  }
  return known.get(name);
}
const testAt = (ambient, test) => engine.cyclicTest({ bearing, ambient, test });

function computeTest() {
  const test = testOfState();
  const steps = state.protocol === "cycles" ? state.count / state.frequency / DT : 0;
  if (steps > MOST_STEPS)
    return { problem: t("too_long", { n: g(Math.round(steps)), most: g(MOST_STEPS) }) };
  const begun = performance.now();
  const cold = testAt(state.ambient, test);
  const ms = performance.now() - begun;
  const warm = once("test", [test, state.reference], () => testAt(state.reference, test));
  return { cold, warm, ms, problem: "" };
}

function motionOfState() {
  return dropped && state.motion === dropped.name ? dropped.motion : state.motion;
}
function computeBridge() {
  const motion = motionOfState();
  const begun = performance.now();
  const cold = engine.bridge({ bearing, ambient: state.ambient, motion });
  const ms = performance.now() - begun;
  const warm = once("bridge", [state.motion, state.reference], () =>
    engine.bridge({ bearing, ambient: state.reference, motion }));
  return { cold, warm, ms };
}

/** The strain of the bearing in the bridge at the reference of the page and under its first motion. */
const strainInBridge = () => once("fit", 0, () =>
  engine.bridge({ bearing, ambient: page.defaults.reference, motion: page.motions[0] }).peaks.bearing_strain);
const fitsBridge = () => strainInBridge() <= page.fitting.strain;
/** Hide the view of the bridge, with the reason, for a bearing that is too small for it. */
function showFit() {
  const fits = fitsBridge();
  el("tab-bridge").hidden = el("save-bridge").hidden = !fits;
  el("unfit").hidden = fits;
  el("unfit").textContent = fits ? "" : t("unfit", {
    name: state.base, t: degrees(page.defaults.reference), motion: page.motions[0], s: short(100 * strainInBridge()),
    limit: short(100 * page.fitting.strain), code: page.fitting.code, start: page.fitting.bearing,
  });
  if (!fits && state.view === "bridge") showView("test");
}

// Sentences on a run.

const degrees = (value) => short(value, 3);
/** Words with a duration; none with one that the clock of the browser may be too coarse for. */
const timed = (ms, key, without, values = {}) => (ms < 1 ? (without ? t(without, values) : "") : t(key, { ...values, ms: short(ms, 2) }));
const largest = (values) => values.reduce((most, value) => Math.max(most, value), -Infinity);
const smallest = (values) => values.reduce((least, value) => Math.min(least, value), Infinity);

function outcomeWords(run) {
  return (language === "ja" && page.outcomes[run.outcome]) || run.sentence;
}

/** Most cycles without a rest, counted as results/ranges.py does: half the alternating extremes. */
function cyclesInARow(time, displacement) {
  const { extreme, rest_s: rest } = page.counting;
  const least = extreme * largest(displacement.map(Math.abs));
  let [most, turns, side, last] = [0, 0, 0, 0];
  for (let k = 0; k < time.length; k++) {
    if (!(Math.abs(displacement[k]) > least)) continue;
    const way = Math.sign(displacement[k]);
    turns = side && time[k] - last > rest ? 1 : turns + Number(way !== side);
    [most, side, last] = [Math.max(most, turns), way, time[k]];
  }
  return most / 2;
}
/** What a run asks of the bearing, lowest and highest, in the units of its calibration range. */
function askedBy(ambient, { time, displacement, temperatures, lead }) {
  const rubber = bearing.rubber_thickness_mm;
  let speed = 0;
  for (let k = 1; k < time.length; k++) {
    const step = time[k] - time[k - 1];
    if (step > 0) speed = Math.max(speed, Math.abs(displacement[k] - displacement[k - 1]) / step);
  }
  const twice = (value) => [value, value];
  return {
    ambient: twice(ambient), strain: twice(largest(displacement.map(Math.abs)) / rubber), strain_rate: twice(speed / rubber),
    cycles: twice(cyclesInARow(time, displacement)),
    ...(lead ? { lead_temperature: [smallest(lead), largest(lead)] } : {}),
    law: [smallest(temperatures), largest(temperatures)],
  };
}
const askedByTest = (ambient, run) => askedBy(ambient, { ...run, temperatures: run.layers.temperature });
const askedByBridge = (ambient, { time, bearing: { displacement_mm: displacement, layer_temperature: temperatures, lead } }) =>
  askedBy(ambient, { time, displacement, temperatures, lead });
const farthest = (one, other) => Object.fromEntries(Object.entries(one).map(([what, [low, high]]) =>
  [what, [Math.min(low, other[what][0]), Math.max(high, other[what][1])]]));
const UNITS = { strain: [100, " %"], strain_rate: [1, "/s"], ambient: [1, " °C"], cycles: [1, ""], lead_temperature: [1, " °C"], law: [1, " °C"] };
/** What lies outside the calibration range, beyond the slack that reports have too. */
function outside(asked) {
  if (!bearing.tested_range) return [t("no_range")];
  const found = [];
  const ranges = { ...bearing.tested_range, law: bearing.law_range };
  for (const [what, range] of Object.entries(ranges)) {
    if (!asked[what] || !range) continue;
    const [low, high] = range;
    const [factor, unit] = UNITS[what];
    const least_slack = unit === " °C" ? page.slack_kelvin : 0;
    const slack = what === "law" ? least_slack : Math.max(page.slack * Math.max(high - low, Math.abs(high)), least_slack);
    const [least, most] = asked[what];
    const far = most > high + slack ? most : least < low - slack ? least : null;
    if (far !== null) found.push(t("outside", { what: t(`what_${what}`), value: short(far * factor), unit, low: short(low * factor), high: short(high * factor) }));
  }
  return found;
}

/** Whether lead that reaches a temperature loses strength: by its own rate, or beyond its tests. */
function leadSoftens(temperature) {
  const warmest = bearing.tested_range?.lead_temperature?.[1] ?? Infinity;
  return temperature > -Infinity && ((bearing.values["lead.softening"] ?? 0) > 0 || temperature > warmest);
}

function answer() {
  const { cold, warm, problem } = runs;
  const lines = [];
  const warnings = [];
  if (problem) return { lines, warnings: [problem] };
  for (const [run, temperature] of [[cold, state.ambient], [warm, state.reference]])
    if (run.outcome !== "completed") warnings.push(`${t("at", { t: degrees(temperature) })}: ${outcomeWords(run)}`);
  const [first, last] = [cold.cycles[0], cold.cycles.at(-1)];
  const both = Math.min(cold.cycles.length, warm.cycles.length); // a run may end early
  const ratio = (at) => fixed(cold.cycles[at].stiffness_kN_mm / warm.cycles[at].stiffness_kN_mm);
  if (both) lines.push(t("headline", { t: degrees(state.ambient), r: degrees(state.reference), a: ratio(0), b: ratio(both - 1), n: both }));
  if (first && cold.cycles.length > 1 && state.protocol === "cycles") {
    const fall = 100 * (1 - last.stiffness_kN_mm / first.stiffness_kN_mm);
    const [rubber, lead] = [largest(last.layer_temperature), last.lead_temperature ?? -Infinity];
    const key = leadSoftens(lead) ? "softens_lead" : "softens";
    if (fall >= 0.5) lines.push(t(key, { p: short(fall, 2), n: cold.cycles.length, h: short(rubber), l: short(lead) }));
  }
  const notes = cold.softened ? [t("softened_layers", { n: cold.softened })] : [];
  const hot = cold.lead ? largest(cold.lead) : -Infinity;
  const hotter = warm.lead ? Math.max(hot, largest(warm.lead)) : hot;
  if (hotter > page.warm_lead) warnings.push(t("melting", { h: short(hotter) }));
  if (isChanged()) warnings.push(t("changed"));
  const beyond = outside(farthest(askedByTest(state.ambient, cold), askedByTest(state.reference, warm)));
  return { lines, warnings: [...warnings, ...beyond], notes, within: !beyond.length };
}

let spokenLater = 0;
/** @param {string} place @param {{lines: string[], warnings: string[], notes?: string[], within?: boolean}} said */
function tell(place, { lines, warnings, notes = [], within = false }) {
  const paragraph = document.createElement("p");
  put(paragraph, lines.join(language === "ja" ? "" : " "));
  const list = document.createElement("ul");
  const calm = within && !warnings.length ? [t("within"), ...notes] : notes;
  for (const words of [...warnings.map((one) => `⚠ ${one}`), ...calm]) {
    const item = document.createElement("li");
    if (words.startsWith("⚠")) item.className = "warn";
    item.textContent = words;
    list.append(item);
  }
  el(place).replaceChildren(paragraph, list);
  // Read aloud when the slider has come to rest, not at every redraw.
  clearTimeout(spokenLater);
  spokenLater = setTimeout(() => (el("spoken").textContent = [...lines, ...warnings].join(" ")), 900);
}

// Tables.

/** @type {[string, string, string, number][]} */
const COLUMNS = [ // name in a cycle, symbol, unit, factor to the shown unit
  ["G_eq_MPa", "G_e", "MPa", 1], ["h_eq", "h_eq", "1", 1], ["stiffness_kN_mm", "K_eq", "kN/mm", 1],
  ["characteristic_strength_kN", "Q_d", "kN", 1], ["energy_kN_mm", "energy", "kJ", 1e-3],
];
const OF_PYTHON = { stiffness_kN_mm: "K_eq_kN_mm" }; // names of Python's table of cycles
function showCycles() {
  const { cold, warm } = runs;
  const strains = new Set(cold.cycles.map(({ strain }) => strain));
  const heads = [t("cycle"), ...(strains.size > 1 ? [t("strain")] : []), ...COLUMNS.map(([, name, unit]) => `${name === "energy" ? t("energy") : name} [${unit}]`), `${t("rubber")} [°C]`];
  if (cold.lead) heads.push(`${t("lead")} [°C]`);
  const rows = cold.cycles.map((cycle, at) => {
    const other = warm.cycles[at];
    const cells = COLUMNS.map(([name, , , factor]) => {
      const relative = other ? ` (${fixed(cycle[name] / other[name])})` : "";
      return fixed(factor * cycle[name]) + relative;
    });
    const row = [String(at + 1), ...(strains.size > 1 ? [short(100 * cycle.strain)] : []), ...cells, `${short(largest(cycle.layer_temperature))}${other ? ` | ${short(largest(other.layer_temperature))}` : ""}`];
    if (cold.lead) row.push(`${short(cycle.lead_temperature)}${other ? ` | ${short(other.lead_temperature)}` : ""}`);
    return row;
  });
  el("cycles-caption").textContent = t("each_cycle", { t: degrees(state.ambient), r: degrees(state.reference) });
  fillTable(el("cycles"), heads, rows);
  showMainNumbers(Math.min(cold.cycles.length, warm.cycles.length));
}
/** The measures of the last cycle in rows, which fit the width of a phone. @param {number} count */
function showMainNumbers(count) {
  const ends = [runs.cold, runs.warm].map((run) => run.cycles[count - 1]);
  el("main-caption").textContent = count ? t("main_numbers", { n: count }) : "";
  const numbers = count ? COLUMNS.map(([name, symbol, unit, factor]) => {
    const [cold, warm] = ends.map((cycle) => factor * cycle[name]);
    return [`${symbol === "energy" ? t("energy") : symbol} [${unit}]`, fixed(cold), fixed(warm), fixed(cold / warm)];
  }) : [];
  const temperatures = count ? [[t("rubber"), (cycle) => largest(cycle.layer_temperature)], [t("lead"), (cycle) => cycle.lead_temperature]]
    .filter(([, of]) => Number.isFinite(of(ends[0])))
    .map(([name, of]) => [`${name} [°C]`, ...ends.map((cycle) => short(of(cycle))), ""]) : [];
  const heads = [t("quantity"), t("at", { t: degrees(state.ambient) }), t("at", { t: degrees(state.reference) }), t("ratio")];
  fillTable(el("main-numbers"), heads, [...numbers, ...temperatures]);
}

// Charts.

const DASH = [7, 4];
function pairOfLines(colours, x, y, name = "") {
  const lines = [
    { ...xy(runsOfView().warm, x, y), colour: colours.warm, dash: DASH, name: name || t("at", { t: degrees(state.reference) }) },
    { ...xy(runsOfView().cold, x, y), colour: colours.cold, name: t("at", { t: degrees(state.ambient) }) },
  ];
  return lines;
}
const xy = (run, x, y) => ({ x: x(run), y: y(run) });
const runsOfView = () => (state.view === "bridge" ? shaken : runs);

function layerLines(colours) {
  const lines = [];
  for (const [run, temperature, colour, dash] of [[runs.warm, state.reference, colours.warm, DASH], [runs.cold, state.ambient, colours.cold, []]]) {
    const { count, temperature: values } = run.layers;
    for (let layer = 0; layer < count; layer++) {
      const y = new Float64Array(run.time.length);
      for (let k = 0; k < y.length; k++) y[k] = values[k * count + layer];
      lines.push({ x: run.time, y, colour, dash, width: 1.2, name: layer ? "" : t("layers_at", { t: degrees(temperature) }) });
    }
    if (run.lead) lines.push({ x: run.time, y: run.lead, colour, dash: [2, 3], width: 2.2, name: t("lead_at", { t: degrees(temperature) }) });
  }
  return lines;
}

/** Cells of the whole height from the top, with their temperatures at a point of time. */
function cellsAt(run, k) {
  const { part, thickness_mm: thickness, half } = bearing.stack;
  const { count, temperature } = run.cells;
  const cells = part.slice(0, count).map((material, at) => ({ material: material.startsWith("end") ? "end" : material.startsWith("rubber") ? "rubber" : "steel", thickness: thickness[at], temperature: temperature[k * count + at] }));
  return half ? [...cells, ...cells.toReversed()] : cells;
}
function momentIndex(run) {
  const last = run.time.length - 1;
  const wanted = (el("moment").valueAsNumber / 1000) * run.time[last];
  let [low, high] = [0, last];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (run.time[middle] < wanted) low = middle + 1;
    else high = middle;
  }
  return low;
}
/** Lowest and highest temperature in the cells during a test; the lead is far hotter. */
function scaleOf(run) {
  const parts = [run.cells.temperature.subarray(-run.cells.count), run.layers.temperature];
  const low = Math.min(...parts.map(smallest));
  return [low, Math.max(...parts.map(largest), low + 5)];
}

const profileLine = (run) => {
  const cells = cellsAt(run, momentIndex(run));
  const x = [];
  const y = [];
  let height = cells.reduce((sum, cell) => sum + cell.thickness, 0);
  for (const cell of cells) {
    x.push(cell.temperature);
    y.push(height - cell.thickness / 2);
    height -= cell.thickness;
  }
  return { x, y };
};

/** Heights of the rubber layers and of the steel between them, with their names for the legend. */
function layerBands() {
  const cells = cellsAt(runs.cold, 0);
  const height = cells.reduce((sum, cell) => sum + cell.thickness, 0);
  return partsOf(cells).map(({ part, depth, thickness }) =>
    ({ part, low: height - depth - thickness, high: height - depth, name: partNames()[part] }));
}
const partNames = () => ({ rubber: t("rubber_part"), steel: t("steel") });

const MAKERS = {
  loops: (colours) => ({ x: t("displacement_axis"), y: t("force_axis"), lines: pairOfLines(colours, (run) => run.displacement, (run) => run.force) }),
  warming: (colours) => ({ x: t("time_axis"), y: t("temperature_axis"), lines: layerLines(colours) }),
  profile: (colours) => {
    const ends = [runs.cold, runs.warm].map(scaleOf);
    const room = (Math.max(ends[0][1], ends[1][1]) - Math.min(ends[0][0], ends[1][0])) * 0.05;
    return {
      x: t("temperature_axis"), y: t("height_axis"), bands: layerBands(),
      xrange: [Math.min(ends[0][0], ends[1][0]) - room, Math.max(ends[0][1], ends[1][1]) + room],
      lines: [
        { ...profileLine(runs.warm), colour: colours.warm, dash: DASH, name: t("at", { t: degrees(state.reference) }) },
        { ...profileLine(runs.cold), colour: colours.cold, name: t("at", { t: degrees(state.ambient) }) },
      ],
    };
  },
  stack: () => {
    const at = momentIndex(runs.cold);
    const cells = cellsAt(runs.cold, at);
    const values = bearing.values;
    const breadth = values["geometry.plan.side"] ?? values["geometry.plan.length"] ?? values["geometry.plan.diameter"];
    const cores = values["lead.cores"] ?? 0;
    const lead = cores && runs.cold.lead
      ? { diameter: values["lead.diameter"], inPlan: Math.max(1, Math.round(Math.sqrt(cores))), temperature: runs.cold.lead[at], cover: values["geometry.end_plate_thickness"] ?? 0 }
      : null;
    const [low, high] = scaleOf(runs.cold);
    return { cells, breadth, lead, names: partNames(), scale: [low, lead ? Math.max(high, largest(runs.cold.lead)) : high] };
  },
  bridge_strain: (colours) => ({ x: t("time_axis"), y: t("strain_axis"), lines: pairOfLines(colours, (run) => run.time, (run) => run.bearing.strain.map((value) => 100 * value)) }),
  bridge_force: (colours) => ({ x: t("displacement_axis"), y: t("force_axis"), lines: pairOfLines(colours, (run) => run.bearing.displacement_mm, (run) => run.bearing.force_kN).map((line) => ({ ...line, width: 1.1 })) }),
  bridge_pier: (colours) => ({ x: t("time_axis"), y: t("pier_axis"), lines: pairOfLines(colours, (run) => run.time, (run) => run.pier.displacement_mm) }),
  codes_curve: (colours) => codesSpec(colours),
};
for (const name of Object.keys(MAKERS)) charts[name] = new Chart(el(name), name === "stack" ? drawStack : drawLines);
const draw = (...names) => names.forEach((name) => charts[name].show(MAKERS[name]));
function describe(names) {
  for (const name of names) {
    const words = name === "loops" && runs && !runs.problem
      ? t("loops_alt", { t: degrees(state.ambient), r: degrees(state.reference), f: short(largest(runs.cold.force)), g: short(largest(runs.warm.force)) })
      : t("chart_alt", { what: t(name) });
    el(name).setAttribute("aria-label", words);
  }
}

// Views.

function showTest() {
  runs = computeTest();
  tell("answer", answer());
  if (runs.problem) return;
  const { cold, ms } = runs;
  el("ring").hidden = !cold.lead;
  draw("loops", "warming", "stack", "profile");
  describe(["loops", "warming", "stack", "profile"]);
  showCycles();
  showMoment();
  el("speed").textContent = timed(ms, "computed", "computed_at_once", { n: cold.steps }) + (rate ? t("redraws", { fps: short(rate, 2) }) : "");
}
function showMoment() {
  const run = runs.cold;
  const words = `${short(run.time[momentIndex(run)])} s`;
  el("moment-value").textContent = words;
  el("moment").setAttribute("aria-valuetext", words);
}

const PEAKS = { bearing_strain: 100, bearing_displacement_mm: 1, bearing_force_kN: 1, pier_moment_kN_m: 1, pier_ductility: 1, pier_displacement_mm: 1, layer_temperature_degC: 1, lead_temperature_degC: 1 };
function showBridge() {
  shaken = computeBridge();
  const { cold, warm, ms } = shaken;
  const values = { t: degrees(state.ambient), r: degrees(state.reference) };
  const [moment, reference] = [cold, warm].map((run) => run.peaks.pier_moment_kN_m);
  const change = Math.round(100 * (moment / reference - 1));
  const key = change > 0 ? "pier_more" : change < 0 ? "pier_less" : "pier_same";
  const pier = Number.isFinite(change) ? [t(key, { ...values, p: Math.abs(change), m: short(moment), mr: short(reference) })] : [];
  const lines = [...pier, t("bridge_words", { ...values, s: short(100 * cold.peaks.bearing_strain), sr: short(100 * warm.peaks.bearing_strain), d: short(cold.peaks.pier_ductility), dr: short(warm.peaks.pier_ductility) })];
  const warnings = [];
  for (const [run, temperature] of [[cold, state.ambient], [warm, state.reference]])
    if (run.outcome !== "completed") warnings.push(`${t("at", { t: degrees(temperature) })}: ${outcomeWords(run)}`);
  const { strain_rate: [, fastest], ...asked } = farthest(askedByBridge(state.ambient, cold), askedByBridge(state.reference, warm));
  if (isChanged()) warnings.push(t("changed"));
  const beyond = outside(asked);
  const tested = bearing.tested_range?.strain_rate?.[1] ?? Infinity; // earthquakes are faster: a note, as in Python
  const notes = fastest > tested * (1 + page.slack) ? [t("rate_note", { v: short(fastest), high: short(tested), n: short(fastest / tested) })] : [];
  const damped = [cold, warm].map((run) => run.damping_of_input);
  const much = damped.filter((share) => share > page.damping_share);
  if (much.length) warnings.push(t("damping_note", { least: short(100 * page.damping_share), n: much.length, all: damped.length, v: Math.round(100 * Math.max(...much)) }));
  tell("bridge-answer", { lines, warnings: [...warnings, ...beyond], notes, within: !beyond.length && !notes.length });
  draw("bridge_strain", "bridge_force", "bridge_pier");
  describe(["bridge_strain", "bridge_force", "bridge_pier"]);
  const rows = Object.entries(PEAKS).filter(([name]) => Number.isFinite(cold.peaks[name])).map(([name, factor]) => {
    const [a, b] = [factor * cold.peaks[name], factor * warm.peaks[name]];
    return [t(name), fixed(a), fixed(b), name.endsWith("degC") ? "" : fixed(a / b)];
  });
  fillTable(el("peaks"), [t("quantity"), t("at", { t: values.t }), t("at", { t: values.r }), t("ratio")], rows);
  el("bridge-time").textContent = timed(ms, "run_time", "");
}

const NAMES = { K_eq: "stiffness_kN_mm", Q_d: "characteristic_strength_kN", K_d: "post_yield_stiffness_kN_mm", h_eq: "h_eq" };
const CODES = { strain: 1, cycles: 3, wave: "sine", frequency_hz: 0.5 };
const GRID = [-40, -30, -20, -10, 0, 10, 20, 30, 40];
const codesRun = (ambient) => once("codes", ambient, () => {
  const { outcome, cycles } = testAt(ambient, CODES);
  return { outcome, cycles };
});
const ofThisKind = (row) => row.kinds.includes(bearing.kind);
/** Published factors, those of the same kind of bearing first. */
const inOrder = () => [...page.factors].sort((one, other) => Number(ofThisKind(other)) - Number(ofThisKind(one)));
function published() {
  return inOrder().map((row) => {
    const { temperatures: x, factors: y } = row;
    const place = x.findIndex((one, k) => k && one >= state.ambient);
    const inside = state.ambient >= x[0] && place > 0;
    const part = inside ? (state.ambient - x[place - 1]) / (x[place] - x[place - 1]) : 0;
    return { ...row, value: inside ? y[place - 1] + part * (y[place] - y[place - 1]) : state.ambient === x[0] ? y[0] : NaN };
  });
}
function codesSpec(colours) {
  const reference = codesRun(state.reference).cycles.at(-1);
  const found = GRID.map((one) => [one, (codesRun(one).cycles.at(-1)?.stiffness_kN_mm ?? NaN) / reference.stiffness_kN_mm]).filter(([, y]) => Number.isFinite(y));
  const now = codesRun(state.ambient).cycles.at(-1);
  const others = inOrder().filter((row) => row.quantity === "K_eq");
  const dashes = [[2, 2], [8, 3, 2, 3], [4, 3], [10, 4]];
  return {
    x: t("temperature_axis"), y: t("factor_axis"), mark: state.ambient,
    lines: [
      { x: found.map(([x]) => x), y: found.map(([, y]) => y), colour: colours.cold, width: 2.4, name: t("this_bearing") },
      ...(now ? [{ x: [state.ambient], y: [now.stiffness_kN_mm / reference.stiffness_kN_mm], colour: colours.cold, points: true }] : []),
      ...others.map((row, at) => ({ x: row.temperatures, y: row.factors, colour: at % 2 ? colours.third : colours.warm, dash: dashes[at % 4], width: ofThisKind(row) ? 1.5 : 0.7, name: row.name.replace(/ \(.*/, "") + (ofThisKind(row) ? "" : ` (${t("codes_other")})`) })),
    ],
  };
}
function showCodes() {
  runs = runs ?? computeTest();
  const [cold, warm] = [codesRun(state.ambient), codesRun(state.reference)];
  const values = { t: degrees(state.ambient), r: degrees(state.reference), s: 100 * CODES.strain, p: 1 / CODES.frequency_hz };
  const leadRise = (run, start) => short(run.cycles[0].lead_temperature - start, 2);
  const hasLead = cold.cycles.length && warm.cycles.length && cold.cycles[0].lead_temperature !== null;
  const heating = hasLead ? t("codes_lead", { ...values, a: leadRise(cold, state.ambient), b: leadRise(warm, state.reference) }) : "";
  el("codes-words").textContent = t("codes_words", { ...values, h: heating });
  if (cold.cycles.length && warm.cycles.length) {
    const shown = [...Object.entries(NAMES).map(([symbol, name]) => [name, symbol]), ["energy_kN_mm", t("energy")]];
    const factor = (name, at) => cold.cycles.at(at)[name] / warm.cycles.at(at)[name];
    fillTable(el("codes"), [t("quantity"), t("codes_first"), t("codes_third")], shown.map(([name, head]) => [head, fixed(factor(name, 0)), fixed(factor(name, -1))]));
    draw("codes_curve");
    describe(["codes_curve"]);
  }
  el("published-caption").textContent = t("codes_published", values);
  el("others-note").textContent = t("codes_others", { kind: bearing.kind });
  fillTable(el("published"), [t("quantity"), t("codes_kind"), t("codes_factor"), t("codes_own"), t("codes_reference"), t("codes_source")], published().map((row) => {
    const [low, high] = [row.temperatures[0], row.temperatures.at(-1)];
    const text = Number.isFinite(row.value) ? fixed(row.value) : t("outside_table", { low: short(low), high: short(high) });
    const [name, there] = [NAMES[row.quantity], codesRun(row.reference_temperature).cycles];
    const own = [0, -1].map((at) => fixed((cold.cycles.at(at)?.[name] ?? NaN) / (there.at(at)?.[name] ?? NaN))).join(" | ");
    const kinds = row.kinds.join(", ") + (ofThisKind(row) ? "" : ` (${t("codes_other")})`);
    return [`${row.quantity}: ${row.name}`, kinds, text, own, `${short(row.reference_temperature)} °C`, row.unverified ? `${row.source} (${t("unverified")})` : row.source];
  }));
}

// Export.

const isChanged = () => Object.keys(state.changes).length > 0;
/** Values of the bearing that differ from those of the library, by the keys of a bearing's file. */
function differences() {
  const library = engine.bearing({ base: state.base }).bearing.values;
  const found = Object.entries(bearing.values).filter(([path, value]) => value !== library[path]);
  const plan = found.some(([path]) => path.startsWith("geometry.plan."));
  const whole = Object.entries(bearing.values).filter(([path]) => path.startsWith("geometry.plan."));
  return [...(plan ? whole : []), ...found.filter(([path]) => !path.startsWith("geometry.plan."))];
}
function bearingToml() {
  const lines = [`name = "${state.base}-changed"`, `based_on = "${nameToLoad()}"`];
  const groups = new Map();
  for (const [path, value] of differences()) {
    const [table, key] = path.split(/\.(?=[^.]*$)/);
    const { unit } = page.ranges[path];
    const text = !unit || unit === "1" ? String(value) : `"${value} ${unit}"`;
    groups.set(table, [...(groups.get(table) ?? []), `${key} = ${text}`]);
  }
  for (const [table, rows] of groups) {
    const plan = table === "geometry.plan";
    const shape = /^side/.test(rows[0]) ? "square" : /^diameter/.test(rows[0]) ? "circular" : "rectangular";
    lines.push("", `[${table}]`, ...(plan ? [`shape = "${shape}"`] : []), ...rows);
  }
  return lines.join("\n");
}
const waveName = () => (state.wave === "triangle" ? "triangular" : "sine");
// What commands and files call the chosen bearing: its name in the library, or its own file.
const nameToLoad = () => (state.base === page.start ? page.start_file : state.base);
const fileOfBearing = () => (isChanged() ? `${state.base}-changed.toml` : nameToLoad());
function caseToml() {
  const cycles = ({ strain, wave, count, ...more }) => `[[test.steps]]\nstep = "cycles"\nstrain = ${strain}\nwave = "${wave}"\ncount = ${count}\n` +
    Object.entries(more).map(([key, value]) => `${key} = ${value}\n`).join("");
  const wave = waveName();
  const steps = state.protocol === "cycles"
    ? [cycles({ strain: state.strain, wave, count: state.count, frequency: `"${state.frequency} Hz"` })]
    : stepsOfProtocol().map((step) => ("cycles" in step
      ? cycles({ strain: step.strain, wave, count: step.cycles, speed: `"${step.speed_mm_s} mm/s"`, closing_strain: step.closing_strain })
      : `[[test.steps]]\nstep = "rest"\nduration = "${step.rest_s} s"\n`));
  const test = steps.join("\n");
  return `bearing = "${fileOfBearing()}"\nambient = ["${state.ambient} degC", "${state.reference} degC"]\n\n${test}`;
}
function showExport() {
  runs = runs ?? computeTest();
  const cycles = state.protocol === "cycles";
  const strains = cycles ? [state.strain] : stepsOfProtocol().flatMap(({ strain }) => strain ?? []);
  const words = `${strains.map((strain) => ` --strain ${strain}`).join("")} --wave ${waveName()}` + (cycles ? ` --frequency ${state.frequency} --cycles ${state.count}` : "");
  el("command-text").textContent = `thermobearing cyclic --bearing ${fileOfBearing()} --ambient ${state.ambient} --ambient ${state.reference}${words} -o test` +
    (!fitsBridge() ? "" : `\nthermobearing bridge --bearing ${fileOfBearing()} --motion ${dropped?.name ?? state.motion} --ambient ${state.ambient} --ambient ${state.reference} -o bridge`);
  const values = cycles ? `strain=${state.strain}, frequency=${state.frequency}, cycles=${state.count}, closing_strain=None, ` : "";
  const test = `, tb.cyclic_test(${values}wave="${waveName()}")`;
  el("python-text").textContent = `import thermobearing as tb\n\nbearing = tb.load_bearing("${fileOfBearing()}")\nresult = tb.run(bearing${test}, ambient=[${state.ambient}, ${state.reference}])\nprint(result.cycles)`;
  el("toml-text").textContent = (isChanged() ? `# ${fileOfBearing()}\n${bearingToml()}\n\n# case.toml\n` : "# case.toml\n") + caseToml();
  el("link-text").textContent = location.href.split("#")[0] + address();
}
function save(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
const csvFile = (rows) => new Blob([rows.map((row) => row.join(",")).join("\n") + "\n"], { type: "text/csv" });
function historiesCsv() {
  const heads = ["ambient_degC", "time_s", "displacement_mm", "force_kN"];
  const { count } = runs.cold.layers;
  for (let layer = 1; layer <= count; layer++) heads.push(`rubber${layer}_degC`);
  if (runs.cold.lead) heads.push("lead_degC");
  /** @type {(string | number)[][]} */
  const rows = [heads];
  for (const [run, ambient] of [[runs.cold, state.ambient], [runs.warm, state.reference]])
    run.time.forEach((time, k) => rows.push([ambient, time, run.displacement[k], run.force[k], ...run.layers.temperature.subarray(k * count, (k + 1) * count), ...(run.lead ? [run.lead[k]] : [])].map((value) => Number(value.toPrecision(9)))));
  return csvFile(rows);
}
function cyclesCsv() {
  const layers = Array.from({ length: runs.cold.layers.count }, (_, k) => `rubber${k + 1}_degC`);
  const rows = [["ambient_degC", "cycle", ...COLUMNS.map(([name]) => OF_PYTHON[name] ?? name), "post_yield_stiffness_kN_mm", ...layers, "lead_degC"]];
  for (const [run, ambient] of [[runs.cold, state.ambient], [runs.warm, state.reference]])
    run.cycles.forEach((cycle, at) => rows.push([ambient, at + 1, ...COLUMNS.map(([name]) => cycle[name]), cycle.post_yield_stiffness_kN_mm, ...cycle.layer_temperature, cycle.lead_temperature ?? ""]));
  return csvFile(rows);
}

function bridgeCsv() {
  const { cold, warm } = computeBridge();
  /** @type {(string | number)[][]} */
  const rows = [["ambient_degC", "time_s", "ground_mm_s2", "bearing_displacement_mm", "bearing_force_kN", "pier_displacement_mm", "pier_ductility"]];
  for (const [{ time, ground, bearing: { displacement_mm: moved, force_kN: force }, pier }, ambient] of [[cold, state.ambient], [warm, state.reference]])
    time.forEach((at, k) => rows.push([ambient, ...[at, ground[k], moved[k], force[k], pier.displacement_mm[k], pier.ductility[k]].map((value) => Number(value.toPrecision(9)))]));
  return csvFile(rows);
}

// What is shown of the state, and when.

const VIEWS = { test: showTest, bearing: showTest, bridge: showBridge, codes: showCodes, export: showExport };
let asked = false;
let rate = 0; // redraws a second while the slider moves
let lastDrawn = 0;
function update() {
  if (asked || !engine) return;
  asked = true;
  requestAnimationFrame(() => {
    asked = false;
    const begun = performance.now();
    if (state.view === "codes") runs = null;
    if (state.view === "export") runs = null;
    VIEWS[state.view]();
    if (state.view === "codes") tell("answer", answerOfCodes());
    const now = performance.now();
    const gap = begun - lastDrawn < 200 ? now - lastDrawn : now - begun;
    rate = rate ? 0.8 * rate + (0.2 * 1000) / Math.max(gap, 1) : 1000 / Math.max(gap, 1);
    lastDrawn = now;
    const marks = document.documentElement.dataset;
    marks.redraws = String(Number(marks.redraws ?? 0) + 1);
    marks.redrawMs = (now - begun).toFixed(1);
    marks.firstLoop ??= now.toFixed(0);
    keepAddress();
  });
}
function answerOfCodes() {
  const cold = codesRun(state.ambient);
  const warnings = cold.outcome === "completed" ? [] : [outcomeWords(testAt(state.ambient, CODES))];
  const ratio = (cold.cycles[0]?.stiffness_kN_mm ?? NaN) / (codesRun(state.reference).cycles[0]?.stiffness_kN_mm ?? NaN);
  const last = (cold.cycles.at(-1)?.stiffness_kN_mm ?? NaN) / (codesRun(state.reference).cycles.at(-1)?.stiffness_kN_mm ?? NaN);
  const lines = [t("headline", { t: degrees(state.ambient), r: degrees(state.reference), a: short(ratio), b: short(last), n: cold.cycles.length })];
  return { lines, warnings: [...warnings, ...outside({ ambient: [state.ambient, state.ambient] })], within: false };
}

function showView(view) {
  state.view = view === "bridge" && !fitsBridge() ? "test" : view;
  for (const tab of document.querySelectorAll("[role=tab]")) {
    const chosen = /** @type {HTMLElement} */ (tab).dataset.view === state.view;
    tab.setAttribute("aria-selected", String(chosen));
    tab.setAttribute("tabindex", chosen ? "0" : "-1");
  }
  el("results").setAttribute("aria-labelledby", `tab-${state.view}`);
  for (const part of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-views]")))
    part.hidden = !part.dataset.views?.split(" ").includes(state.view);
  update();
}

function showWords() {
  document.documentElement.lang = language;
  document.title = t("title");
  for (const part of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-word]"))) put(part, t(part.dataset.word));
  for (const part of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-label]"))) part.setAttribute("aria-label", t(part.dataset.label));
  el("language").textContent = t("language");
  el("language").lang = language === "ja" ? "en" : "ja";
  el("made").textContent = t("made_by", { version: page.version, sources: engine ? engine.sources.slice(0, 12) : "" });
  if (bearing) showSizes();
}

function showControls() {
  el("slider").value = state.ambient;
  el("slider-value").textContent = `${degrees(state.ambient)} °C`;
  el("slider").setAttribute("aria-valuetext", `${state.ambient} °C`);
  for (const [name, { factor }] of Object.entries(FIELDS)) {
    el(name).value = g(state[name] / factor);
    mark(el(name), "");
  }
  for (const name of ["base", "protocol", "wave", "motion"]) el(name).value = state[name];
  for (const name of ["strain", "frequency", "count"]) el(name).disabled = state.protocol !== "cycles";
}

const planOf = ({ plan, values }) => `${plan.shape === "circular" ? "⌀ " : ""}${plan.sizes.map((size) => g(values[size])).join(" × ")}`;
const nameOf = (one) => `${one.name} (${one.kind}, ${planOf(one)} mm)`;
/** The fields of sizes and parameters of the bearing that is shown. */
function showSizes() {
  for (const option of el("base").options) option.text = nameOf(option.value === state.base ? bearing : engine.library[option.value]);
  const form = el("sizes");
  const fields = Object.keys(page.labels).filter((path) => path in bearing.values).map((path) => [path, bearing.values[path]]);
  form.replaceChildren();
  for (const [path, value] of fields) {
    const box = document.createElement("div");
    box.className = "field";
    const label = document.createElement("label");
    const input = document.createElement("input");
    const error = document.createElement("p");
    const name = `size-${path.replaceAll(".", "-")}`;
    const unit = page.ranges[path]?.unit;
    label.htmlFor = input.id = name;
    put(label, `${page.labels[path][language]}${unit && unit !== "1" ? ` [${unit}]` : ""}`);
    Object.assign(input, { type: "text", inputMode: "decimal", autocomplete: "off", value: g(value) });
    input.setAttribute("aria-describedby", `${name}-error`);
    Object.assign(error, { id: `${name}-error`, className: "error" });
    input.addEventListener("change", () => changeSize(path, input));
    box.append(label, input, error);
    form.append(box);
  }
  const { values } = bearing;
  const cores = values["lead.cores"] ?? 0;
  el("bearing-facts").textContent = t("whole", {
    name: bearing.name, kind: bearing.kind, sizes: planOf(bearing), layers: values["geometry.rubber_layers"],
    thickness: g(values["geometry.rubber_thickness"]), rubber: short(bearing.rubber_thickness_mm),
    lead: cores ? t("whole_lead", { cores, diameter: g(values["lead.diameter"]) }) : "",
  });
  showFit();
  el("facts").textContent = t("facts", { kind: bearing.kind, layers: bearing.values["geometry.rubber_layers"], rubber: short(bearing.rubber_thickness_mm), area: short(bearing.area_mm2 / 100, 4) }) + (bearing.description && !isChanged() ? ` – ${bearing.description}` : "");
}
/** Numbers that follow the sizes, so that the compound stays the same (rules: bearing/scaling.py). */
function scaled(changes) {
  const before = engine.bearing({ base: state.base }).bearing.values;
  const after = { ...before, ...changes };
  const ratio = (size) => size(after) / size(before);
  const core = (values) => ((values["lead.diameter"] ?? 1) ** 2 * Math.PI) / 4;
  const plan = (values) => {
    const along = values["geometry.plan.side"] ?? values["geometry.plan.diameter"] ?? values["geometry.plan.length"];
    return along * (values["geometry.plan.width"] ?? along) * ("geometry.plan.diameter" in values ? Math.PI / 4 : 1);
  };
  const layer = (values) => values["geometry.rubber_thickness"];
  const sizes = {
    layer: ratio(layer),
    height: ratio((values) => layer(values) * values["geometry.rubber_layers"]),
    core_area: ratio(core),
    net_area: ratio((values) => plan(values) - (values["lead.cores"] ?? 0) * core(values)),
  };
  const found = { ...changes };
  for (const [path, powers] of Object.entries(page.scaling)) {
    if (path in changes || !(path in before)) continue;
    const factor = Object.entries(powers).reduce((all, [size, power]) => all * sizes[size] ** power, 1);
    if (Math.abs(factor - 1) > 1e-12) found[path] = Number((before[path] * factor).toPrecision(12));
  }
  return found;
}
const made = (changes) => engine.bearing({ base: state.base, ...scaled(changes) });
function changeSize(path, input) {
  const text = input.value.replace(",", ".").trim();
  if (text === "" || !Number.isFinite(Number(text)))
    return mark(input, `${path} = '${input.value}': ${allowed(page.ranges[path])}`);
  const changes = { ...state.changes, [path]: Number(text) };
  // A size that is refused itself must not spoil the numbers that follow from it.
  const found = isOutside(Number(text), page.ranges[path]) ? engine.bearing({ base: state.base, ...changes }) : made(changes);
  el("sizes-error").textContent = "";
  if (!found.ok) {
    const own = found.errors.filter((error) => error.field === path);
    mark(input, own.map((error) => error.message).join("; "));
    if (!own.length) el("sizes-error").textContent = found.errors.map((error) => error.message).join("; ");
    return input.setAttribute("aria-invalid", "true");
  }
  state.changes = changes;
  bearing = found.bearing;
  const active = document.activeElement?.id;
  showSizes();
  if (active) el(active)?.focus();
  update();
}
function chooseBearing(changes = {}) {
  const found = made(changes);
  state.changes = found.ok ? changes : {};
  bearing = found.ok ? found.bearing : engine.bearing({ base: state.base }).bearing;
  el("sizes-error").textContent = found.ok ? "" : found.errors.map((error) => error.message).join("; ");
  showSizes();
}

// A motion of the user: two columns of numbers; the unit is gal, or that above them.
function unitOf(heads) {
  const words = heads.toLowerCase().replaceAll("^", "").replaceAll("²", "2").split(/[\s,;()[\]]+/);
  const unit = /[[(]\s*g\s*[\])]/i.test(heads) ? "g" : words.find((word) => word !== "g" && word in page.accelerations);
  return page.accelerations[unit ?? "gal"];
}
async function takeFile(file) {
  const lines = (await file.text()).split(/\r?\n/).map((line) => [line, line.trim().split(/[,;\t ]+/).map(Number)]);
  const isRow = ([, row]) => row.length >= 2 && row.slice(0, 2).every(Number.isFinite);
  const rows = lines.filter(isRow).map(([, row]) => row);
  const unit = unitOf(lines.filter((line) => !isRow(line)).map(([line]) => line).join(" "));
  el("file-error").textContent = "";
  const dt = rows.length > 1 ? (rows.at(-1)[0] - rows[0][0]) / (rows.length - 1) : 0;
  if (rows.length < 10 || !(dt > 0)) return void (el("file-error").textContent = t("bad_csv", { name: file.name }));
  const uneven = rows.findIndex((row, k) => k && Math.abs(row[0] - rows[k - 1][0] - dt) > 0.02 * dt);
  if (uneven > 0) return void (el("file-error").textContent = t("bad_step", { name: file.name, row: uneven + 1 }));
  const accelerations = rows.map((row) => unit * row[1]);
  const peak = largest(accelerations.map(Math.abs)) / page.accelerations.gal;
  const [low, high] = page.peaks_gal;
  if (peak < low || peak > high) return void (el("file-error").textContent = t("bad_peak", { name: file.name, peak: short(peak), low, high }));
  dropped = { name: file.name, motion: { dt_s: dt, acceleration_mm_s2: accelerations } };
  const option = el("motion").querySelector("[data-dropped]") ?? el("motion").appendChild(document.createElement("option"));
  option.dataset.dropped = "";
  option.value = option.textContent = file.name;
  state.motion = el("motion").value = file.name;
  el("file-name").textContent = t("dropped", { name: file.name, n: rows.length, dt: short(dt), peak: short(peak) });
  kept.bridge.clear();
  update();
}

function listen() {
  el("slider").addEventListener("input", () => {
    state.ambient = el("slider").valueAsNumber;
    el("slider-value").textContent = `${degrees(state.ambient)} °C`;
    el("slider").setAttribute("aria-valuetext", `${state.ambient} °C`);
    update();
  });
  for (const name of Object.keys(FIELDS))
    el(name).addEventListener("input", () => {
      const text = el(name).value;
      const problem = refusal(name, text);
      mark(el(name), problem);
      if (problem) return;
      state[name] = Number((Number(text.replace(",", ".")) * FIELDS[name].factor).toPrecision(12));
      update();
    });
  for (const name of ["protocol", "wave", "motion"])
    el(name).addEventListener("change", () => {
      state[name] = el(name).value;
      showControls();
      update();
    });
  el("base").addEventListener("change", () => {
    state.base = el("base").value;
    chooseBearing();
    update();
  });
  el("reset").addEventListener("click", () => { chooseBearing(); update(); });
  el("sizes").addEventListener("submit", (event) => event.preventDefault());
  const tabs = /** @type {HTMLElement[]} */ ([...document.querySelectorAll("[role=tab]")]);
  for (const tab of tabs) {
    tab.addEventListener("click", () => showView(tab.dataset.view));
    tab.addEventListener("keydown", (event) => {
      const way = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!way) return;
      const shown = tabs.filter((one) => !one.hidden);
      const next = shown[(shown.indexOf(tab) + way + shown.length) % shown.length];
      next.focus();
      next.click();
    });
  }
  let playing = 0;
  const redraw = () => { draw("stack", "profile"); showMoment(); };
  const stop = () => {
    cancelAnimationFrame(playing);
    playing = 0;
    el("play").setAttribute("aria-pressed", "false");
    el("play").textContent = t("play");
  };
  el("moment").addEventListener("input", redraw);
  el("play").addEventListener("click", () => {
    if (playing) return stop();
    if (el("moment").valueAsNumber >= 1000) el("moment").value = 0;
    el("play").setAttribute("aria-pressed", "true");
    el("play").textContent = t("pause");
    let last = performance.now();
    const step = (now) => {
      el("moment").value = String(Math.min(1000, el("moment").valueAsNumber + Math.max(1, Math.round((now - last) / 6))));
      last = now;
      redraw();
      if (el("moment").valueAsNumber >= 1000) return stop();
      playing = requestAnimationFrame(step);
    };
    playing = requestAnimationFrame(step);
  });
  el("language").addEventListener("click", () => {
    language = language === "ja" ? "en" : "ja";
    showWords();
    update();
  });
  el("theme").addEventListener("click", () => {
    const dark = el("theme").getAttribute("aria-pressed") !== "true";
    setTheme(dark);
    update();
  });
  el("file").addEventListener("change", () => el("file").files[0] && takeFile(el("file").files[0]));
  const place = el("bridge-drop");
  for (const kind of ["dragover", "dragleave", "drop"])
    place.addEventListener(kind, (event) => {
      event.preventDefault();
      place.classList.toggle("over", kind === "dragover");
      if (kind === "drop" && event.dataTransfer?.files[0]) takeFile(event.dataTransfer.files[0]);
    });
  el("save-csv").addEventListener("click", () => save("histories.csv", historiesCsv()));
  el("save-cycles").addEventListener("click", () => save("cycles.csv", cyclesCsv()));
  el("save-bridge").addEventListener("click", () => save("bridge.csv", bridgeCsv()));
  el("save-svg").addEventListener("click", () => save("loops.svg", new Blob([loopsFile().svg()], { type: "image/svg+xml" })));
  el("save-png").addEventListener("click", async () => save("loops.png", await loopsFile().png()));
  el("save-toml").addEventListener("click", () => {
    if (isChanged()) save(fileOfBearing(), new Blob([`${bearingToml()}\n`]));
    save("case.toml", new Blob([caseToml()]));
  });
  for (const button of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll(".copy")))
    button.addEventListener("click", async () => {
      const text = el(button.dataset.copy).textContent;
      try {
        await navigator.clipboard.writeText(text);
        el("copied").textContent = t("copied");
      } catch { // of a file, a browser may forbid it; the text is then selected
        getSelection()?.selectAllChildren(el(button.dataset.copy));
      }
    });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { setTheme(matchMedia("(prefers-color-scheme: dark)").matches); update(); });
  const again = (light) => { for (const chart of Object.values(charts)) chart.again(light); };
  addEventListener("beforeprint", () => again(true));
  addEventListener("afterprint", () => again(false));
  addEventListener("hashchange", () => { readAddress(); chooseBearing(state.changes); showControls(); showWords(); showView(state.view); });
}
/** @returns {Chart} */
function loopsFile() {
  charts.loops.make = MAKERS.loops;
  return charts.loops;
}
function setTheme(dark) {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  el("theme").setAttribute("aria-pressed", String(dark));
}

async function begin() {
  setTheme(matchMedia("(prefers-color-scheme: dark)").matches);
  try {
    const data = JSON.parse(new TextDecoder().decode(await unpacked(el("engine-data").textContent)));
    Object.assign(page, { factors: data.factors.tables, protocols: data.protocols, ranges: data.fields, motions: Object.keys(data.motions) });
    engine = await createEngine(await unpacked(el("engine-module").textContent), data);
  } catch (error) {
    el("starting").hidden = true;
    el("blocked").hidden = false;
    showWords();
    el("blocked").textContent = `${t("no_wasm")} (${error})`;
    return;
  }
  el("starting").hidden = true;
  for (const one of engine.bearings) el("base").append(new Option(nameOf(one), one.name));
  for (const name of page.motions) el("motion").append(new Option(name, name));
  readAddress();
  chooseBearing(state.changes);
  showWords();
  showControls();
  listen();
  watchBroadTables();
  showView(state.view);
}
begin();
