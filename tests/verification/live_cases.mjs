// The results of cases of the live page as JSON, in node and in a browser.

function runCase(engine, { changes, ambient, test, motion }) {
  const found = engine.bearing(changes);
  if (!found.ok) return { refused: found.errors.map((error) => error.message) };
  const { bearing } = found;
  if (motion) {
    const { outcome, time, bearing: line, pier, peaks, damping_of_input } =
      engine.bridge({ bearing, ambient, motion, keepEvery: 1 });
    return { outcome, time, displacement: line.displacement_mm, force: line.force_kN,
      temperature: line.layer_temperature, rotation: pier.rotation, damping_of_input: [damping_of_input], peaks, lead_ends: bearing.lead_ends };
  }
  const { outcome, time, displacement, force, layers, lead, cycles, softened, steps } =
    engine.cyclicTest({ bearing, ambient, test });
  return { outcome, time, displacement, force, temperature: layers.temperature, lead, cycles, softened,
    steps, lead_ends: bearing.lead_ends };
}

const listed = (_, value) => (ArrayBuffer.isView(value) ? Array.from(value) : value);

export function runCases(engine, cases) {
  const results = cases.map((one) => runCase(engine, one));
  const before = engine.kernels.memory.buffer.byteLength;
  const started = performance.now();
  for (let k = 0; k < 1000; k++) runCase(engine, cases[0]);
  const milliseconds = (performance.now() - started) / 1e3;
  const grown = engine.kernels.memory.buffer.byteLength - before;
  return JSON.stringify({ results, grown, milliseconds, sources: engine.sources }, listed);
}
