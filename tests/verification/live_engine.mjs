// node live_engine.mjs ENGINE MODULE DATA CASES: the results of cases of the live page as JSON.
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [engineFile, moduleFile, dataFile, casesFile] = process.argv.slice(2);
const { createEngine } = await import(pathToFileURL(engineFile).href);
const json = (file) => JSON.parse(readFileSync(file, "utf8"));
const engine = await createEngine(readFileSync(moduleFile), json(dataFile));

function runCase({ changes, ambient, test, motion }) {
  const found = engine.bearing(changes);
  if (!found.ok) return found;
  const { bearing } = found;
  if (motion) {
    const { outcome, time, bearing: line, pier, peaks } = engine.bridge({ bearing, ambient, motion });
    return { outcome, time, displacement: line.displacement_mm, force: line.force_kN,
      temperature: line.layer_temperature, rotation: pier.rotation, peaks, lead_ends: bearing.lead_ends };
  }
  const { outcome, time, displacement, force, layers, lead, cycles, softened, steps } =
    engine.cyclicTest({ bearing, ambient, test });
  return { outcome, time, displacement, force, temperature: layers.temperature, lead, cycles, softened,
    steps, lead_ends: bearing.lead_ends };
}

const listed = (_, value) => (ArrayBuffer.isView(value) ? Array.from(value) : value);
const cases = json(casesFile);
const results = cases.map(runCase);
runCase(cases[0]);
const before = engine.kernels.memory.buffer.byteLength;
const started = performance.now();
for (let k = 0; k < 1000; k++) runCase(cases[0]);
const seconds = (performance.now() - started) / 1e6;
const grown = engine.kernels.memory.buffer.byteLength - before;
console.log(JSON.stringify({ results, grown, seconds, sources: engine.sources }, listed));
