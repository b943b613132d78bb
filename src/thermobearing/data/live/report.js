// The live section of a report: the analysis computed again while a reader moves its conditions.
import { createEngine, unpacked } from "./engine.js";
import { Chart, drawLines, fillTable, short } from "./draw.js";

const LEAST_STRAIN = 0.01; // of the slider
const MOST_STRAIN = 5; // as cyclic/protocol.py has it
const SAME_CYCLES = 0.999; // of the largest amplitude: cycles whose numbers a report compares
const DASH = [7, 4];
const el = (name) => /** @type {any} */ (document.getElementById(name));
const percent = (strain) => `${short(100 * strain)}\u00a0%`; // in one line with its unit
const celsius = (temperature) => `${short(temperature)}\u00a0°C`;
const largest = (values) => values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
const highest = (values) => values.reduce((most, value) => Math.max(most, value), -Infinity);

let engine, given, chart; // the engine, what Python gave, the drawing of the loops
const now = { run: /** @type {any} */ (null), ambient: 0, strain: 0 };

/** A test whose steps have other amplitudes; the closing cycles stay. */
function testAt(strain) {
  const factor = strain / given.strain;
  const scaled = (size) => (size === null ? null : factor === 1 ? size : factor * size);
  const steps = given.test.steps.map((step) =>
    "cycles" in step ? { ...step, strain: scaled(step.strain), amplitude_mm: scaled(step.amplitude_mm) } : step);
  return { ...given.test, steps };
}

/** A cyclic test: its numbers by the keys of the table, and its loops. */
function cyclic(bearing, ambient, strain) {
  const found = engine.cyclicTest({ bearing, ambient, test: testAt(strain) });
  const most = highest(found.cycles.map((cycle) => cycle.strain));
  const cycles = found.cycles.filter((cycle) => cycle.strain >= SAME_CYCLES * most);
  const numbers = { force: largest(found.force) };
  for (const [which, cycle] of [["last", cycles.at(-1)], ["first", cycles[0]]].slice(0, cycles.length))
    for (const [key, value] of Object.entries(cycle))
      numbers[`${which}.${key}`] = key === "layer_temperature" ? highest(value) : value;
  const rubber = bearing.rubber_thickness_mm;
  return { ...found, numbers, x: found.displacement.map((d) => (100 * d) / rubber), y: found.force };
}

/** A bridge in an earthquake, the same way. */
function bridge(bearing, ambient, motion) {
  const found = engine.bridge({ bearing, ambient, motion, keepEvery: 1 });
  const { strain, force_kN: force } = found.bearing;
  const numbers = { ...found.peaks, deck_mm: largest(found.pier.deck_mm) };
  return { ...found, numbers, x: strain.map((value) => 100 * value), y: force };
}

function computed({ run, ambient, strain }) {
  const bearing = engine.library[run.bearing];
  return run.motion ? bridge(bearing, ambient, run.motion) : cyclic(bearing, ambient, strain);
}

/** What left the range that the parameters of the bearing were calibrated in. */
function outside(live) {
  const ranges = engine.library[now.run.bearing].tested_range ?? {};
  const asked = { "ambient temperature": [now.ambient, ranges.ambient, celsius], "shear strain": [largest(live.x) / 100, ranges.strain, percent] };
  return Object.entries(asked).flatMap(([what, [value, range, words]]) => {
    const least = what === "ambient temperature" ? given.slack_kelvin : 0;
    const slack = range ? Math.max(given.slack * Math.max(range[1] - range[0], Math.abs(range[1])), least) : 0;
    const beyond = range && (value > range[1] + slack || (what !== "shear strain" && value < range[0] - slack));
    return beyond ? [`The ${what} of ${words(value)} is outside the calibration range, ${words(range[0])} to ${words(range[1])}.`] : [];
  });
}

/** The numbers of the report, the live ones, and their ratio; whether the texts say the same. */
function table(live, printed) {
  let same = true;
  const text = (value, digits) => (Number.isFinite(value) ? value.toFixed(digits).replace(/^-/, "−") : "–");
  const rows = given.rows.filter(({ key }) => key in printed || key in live).map(({ key, label, factor, digits, ratio }) => {
    const [one, other] = [factor * (printed[key] ?? NaN), factor * (live[key] ?? NaN)];
    same &&= !(key in printed) || Math.abs(one - other) <= 1.01 * 10 ** -digits;
    return [label, text(one, digits), text(other, digits), ratio ? text(other / one, 3) : ""];
  });
  return { rows, same };
}

const conditions = ({ ambient, strain }) => celsius(ambient) + (given.strain ? `, ${percent(strain)}` : "");
const ofReport = () => ({ run: now.run, ambient: now.run.ambient, strain: given.strain });
const kept = new Map(); // runs at the conditions of the report, by their place

function show() {
  const place = given.runs.indexOf(now.run);
  if (!kept.has(place)) kept.clear(), kept.set(place, computed(ofReport()));
  const moved = now.ambient !== now.run.ambient || now.strain !== given.strain;
  const before = kept.get(place);
  const live = moved ? computed(now) : before;
  const { rows, same } = table(live.numbers, now.run.numbers);
  fillTable(el("live-table"), ["Quantity", `Report, ${conditions(ofReport())}`, `Live, ${conditions(now)}`, "Live / report"], rows);
  const agreed = same ? "The live numbers agree with those of the report within one unit of the last digit."
    : "The live numbers differ from those of the report: the result is of another version of the program or its files were changed.";
  const faults = [...(live.outcome === "completed" ? [] : [live.sentence ?? live.outcome]), ...outside(live)];
  const words = [moved ? `Conditions of the report: ${conditions(ofReport())}. Live: ${conditions(now)}.` : agreed, ...faults].join(" ");
  el("live-words").textContent = words;
  el("live-words").className = faults.length || (!moved && !same) ? "box warning" : "";
  chart.show((colours) => ({
    x: "shear strain [%]", y: given.strain ? "force [kN]" : "force of one bearing [kN]",
    lines: [
      { x: live.x, y: live.y, colour: colours.cold, name: `live, ${conditions(now)}` },
      { x: before.x, y: before.y, colour: colours.warm, dash: DASH, name: `report, ${conditions(ofReport())}` },
    ],
  }));
  el("live-loops").setAttribute("aria-label", `Hysteresis loops at the conditions of the report and live. ${words}`);
  for (const [name, value] of [["ambient", celsius(now.ambient)], ["strain", percent(now.strain)]]) {
    const slider = el(`live-${name}`);
    slider?.setAttribute("aria-valuetext", value);
    if (slider) slider.nextElementSibling.textContent = value;
  }
  el("live").shown = { live, before, same, moved }; // for those who read the page by a script
  speak(words);
}

let [asked, spokenLater] = [0, 0];
const update = () => (asked ||= requestAnimationFrame(() => { asked = 0; show(); }));
/** Read aloud when the slider has come to rest, not at every redraw. */
function speak(words) {
  clearTimeout(spokenLater);
  spokenLater = setTimeout(() => { if (el("live").contains(document.activeElement)) el("status").textContent = words; }, 900);
}

/** Go to the conditions of a run of the report. */
function choose(run) {
  Object.assign(now, { run, ambient: run.ambient, strain: given.strain });
  Object.assign(el("live-ambient"), { min: Math.min(-40, run.ambient), max: Math.max(40, run.ambient), value: run.ambient });
  const ends = { min: Math.min(10, 50 * given.strain), max: Math.min(Math.max(250, 150 * given.strain), 100 * MOST_STRAIN) };
  if (given.strain) Object.assign(el("live-strain"), ends, { value: 100 * given.strain });
}

async function begin() {
  given = JSON.parse(new TextDecoder().decode(await unpacked(el("live-data").textContent)));
  engine = await createEngine(await unpacked(el("live-module").textContent), given.engine);
  for (const [name, factor] of Object.entries(given.factors ?? {}))
    engine.motions[name].acceleration_mm_s2 = engine.motions[name].acceleration_mm_s2.map((value) => factor * value);
  chart = new Chart(el("live-loops"), drawLines);
  choose(given.runs[0]);
  el("live-ambient").addEventListener("input", () => { now.ambient = el("live-ambient").valueAsNumber; update(); });
  el("live-strain")?.addEventListener("input", () => { now.strain = Math.max(LEAST_STRAIN, el("live-strain").valueAsNumber / 100); update(); });
  el("live-run")?.addEventListener("change", () => { choose(given.runs[el("live-run").selectedIndex]); update(); });
  el("live-back").addEventListener("click", () => { choose(now.run); update(); });
  document.addEventListener("themechange", () => chart.again());
  show();
  for (const part of document.querySelectorAll(".live-only")) part.removeAttribute("hidden");
}
// Without WebAssembly, or where a policy forbids it, the section stays hidden.
begin().catch((error) => console.info(`no live section: ${error}`));
