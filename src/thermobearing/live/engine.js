/**
 * The engine of the live page: bearings, cyclic tests and bridges, computed by the kernels of the
 * package, which were compiled to WebAssembly. This module lays out their arguments and names
 * their results; it has no physics of its own. Units: mm, kN, s, degC.
 *
 * @typedef {{shape: number[], bytes?: Uint8Array, address?: number, run?: number, size?: number, kind?: string,
 *     of?: Room, row?: number}} Room
 *     an array of a kernel: its content, a row of another array or, without either, zeros;
 *     `address` is where it is in a run
 * @typedef {Record<string, any>} Tree  numbers and arrays by name, as records of the kernels
 */

const SLOT = 8; // bytes of an entry of a table
const PAGE = 65536;
const STACK = 4 * PAGE; // room of the module for its own data beside its size
const SIZES = /** @type {Record<string, number>} */ ({ "<f8": 8, "<i8": 8, "<f4": 4, "<i4": 4, "|b1": 1 });
const FEWEST_STEPS = 2; // in a quarter of a cycle, as cyclic/protocol.py has them, and the next
const REST_START = 0.1;
const REST_GROWTH = 1.05;
const REST_STEPS = 100;
const LONGEST_REST_STEP = 600;
const SETTLE_LIMIT = 14 * 24 * 3600;
const TINY = 1e-9;

/** Product of two 128-bit numbers, which the compiler expects of its surroundings. */
function multiply128(memory) {
  return (/** @type {number} */ at, /** @type {bigint} */ a, /** @type {bigint} */ b,
          /** @type {bigint} */ c, /** @type {bigint} */ d) => {
    const whole = (/** @type {bigint} */ low, /** @type {bigint} */ high) =>
      (BigInt.asUintN(64, high) << 64n) | BigInt.asUintN(64, low);
    const product = BigInt.asUintN(128, whole(a, b) * whole(c, d));
    const view = new DataView(memory.buffer);
    view.setBigUint64(at, product & 0xffffffffffffffffn, true);
    view.setBigUint64(at + SLOT, product >> 64n, true);
  };
}

/** @param {string} text @returns {Uint8Array} */
function decode(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

/** What Python packed: gzip in base64. @param {string} text @returns {Promise<Uint8Array>} */
export async function unpacked(text) {
  const stream = new Blob([decode(text.trim())]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Arrays of a tree of the data, from text to bytes. @param {any} tree @returns {any} */
function decoded(tree) {
  if (tree === null || typeof tree !== "object") return tree;
  if ("bytes" in tree) return { shape: tree.shape, bytes: decode(tree.bytes) };
  return Object.fromEntries(Object.entries(tree).map(([name, one]) => [name, decoded(one)]));
}

/** @param {ArrayLike<number>} values @returns {Room} */
function floats(values) {
  const content = Float64Array.from(values);
  return { shape: [content.length], bytes: new Uint8Array(content.buffer) };
}

/** @param {boolean[] | Uint8Array} values @returns {Room} */
function flags(values) {
  return { shape: [values.length], bytes: Uint8Array.from(values, Number) };
}

/** @param {number[]} values @returns {Room} */
function wholes(values) {
  const content = BigInt64Array.from(values, BigInt);
  return { shape: [content.length], bytes: new Uint8Array(content.buffer) };
}

/** @param {...number} shape @returns {Room} */
const room = (...shape) => ({ shape });

/** @param {Room} given @returns {Float64Array} */
function numbers(given) {
  const bytes = /** @type {Uint8Array} */ (given.bytes);
  return new Float64Array(bytes.slice().buffer);
}

/** The kernels in their memory: every run begins with all memory free. */
class Kernels {
  /** @param {WebAssembly.Instance} instance @param {WebAssembly.Memory} memory @param {number} heap @param {any} layouts */
  constructor(instance, memory, heap, layouts) {
    this.faces = /** @type {any} */ (instance.exports);
    this.memory = memory;
    this.heap = heap;
    this.layouts = layouts;
    this.free = heap;
    this.run = 0;
  }

  /** Forget all arrays of the run before. */
  begin() {
    this.free = this.heap;
    this.run += 1;
  }

  /** @param {number} size @returns {number} the address of so many bytes, all zero */
  allocate(size) {
    const at = this.free;
    this.free = (at + size + 15) & ~15;
    const missing = this.free - this.memory.buffer.byteLength;
    if (missing > 0) this.memory.grow(Math.ceil(missing / PAGE));
    new Uint8Array(this.memory.buffer, at, size).fill(0);
    return at;
  }

  /** @param {any} kind @returns {number} bytes of an entry of an array */
  itemSize(kind) {
    const row = this.layouts.rows[kind.array];
    return row ? row.size : SIZES[kind.array];
  }

  /** Put an array into memory once a run. @param {any} kind @param {Room} array @returns {number} */
  place(kind, array) {
    if (array.of) {
      const size = array.shape.reduce((product, n) => product * n, this.itemSize(kind));
      return this.place(kind, array.of) + (array.row ?? 0) * size;
    }
    if (array.run !== this.run) {
      array.size = this.itemSize(kind);
      array.kind = kind.array;
      const size = array.shape.reduce((product, n) => product * n, array.size);
      array.address = this.allocate(size);
      array.run = this.run;
      if (array.bytes) new Uint8Array(this.memory.buffer).set(array.bytes, array.address);
    }
    return /** @type {number} */ (array.address);
  }

  /** @param {any} kind @returns {any[]} kinds of the slots of an argument */
  fields(kind) {
    return this.layouts.records[kind.record];
  }

  /** Append the slots of an argument. @param {any} kind @param {any} value @param {(number | bigint)[]} slots */
  add(kind, value, slots) {
    if (kind === "float") slots.push(Number(value));
    else if (typeof kind === "string") slots.push(BigInt(value));
    else if (kind.array) {
      slots.push(BigInt(this.place(kind, value)), ...value.shape.map(BigInt));
    } else if (kind.record) {
      for (const [name, one] of this.fields(kind)) {
        if (!(name in value)) throw new Error(`The kernels take "${name}" of ${kind.record}, which the engine does not give.`);
        this.add(one, value[name], slots);
      }
    } else {
      /** @type {(number | bigint)[]} */
      const inner = [];
      for (const one of value) this.add(kind.tuple, one, inner);
      slots.push(BigInt(this.table(inner)), BigInt(value.length));
    }
  }

  /** @param {(number | bigint)[]} slots @param {number} [more] @returns {number} address */
  table(slots, more = 0) {
    const at = this.allocate(SLOT * (slots.length + more));
    const view = new DataView(this.memory.buffer, at);
    slots.forEach((slot, k) => {
      if (typeof slot === "bigint") view.setBigInt64(SLOT * k, slot, true);
      else view.setFloat64(SLOT * k, slot, true);
    });
    return at;
  }

  /** Call a kernel by its name in the package. @param {string} name @param {...any} given @returns {number[]} */
  call(name, ...given) {
    const entry = this.layouts.entries[name];
    /** @type {(number | bigint)[]} */
    const slots = [];
    entry.arguments.forEach(([, kind], /** @type {number} */ k) => {
      if (!kind.record) return this.add(kind, given[k], slots);
      /** @type {(number | bigint)[]} */
      const inner = [];
      this.add(kind, given[k], inner);
      slots.push(BigInt(this.table(inner)));
    });
    const at = this.table(slots, entry.results.length);
    this.faces[entry.symbol](at);
    const view = new DataView(this.memory.buffer, at + SLOT * slots.length);
    return entry.results.map((/** @type {string} */ kind, /** @type {number} */ k) =>
      kind === "float" ? view.getFloat64(SLOT * k, true) : Number(view.getBigInt64(SLOT * k, true)));
  }

  /** A copy of the numbers of an array. @param {Room} array @param {number} [count] rows @returns {Float64Array} */
  read(array, count = array.shape[0]) {
    const size = array.shape.slice(1).reduce((product, n) => product * n, count);
    return new Float64Array(this.memory.buffer, array.address, size).slice();
  }

  /** A copy of a number of every row. @param {string} name @param {any} array @param {number} count @param {number} [step] rows from one to the next @returns {Float64Array} */
  column(name, array, count, step = 1) {
    const { fields, size } = this.layouts.rows[array.kind];
    const offset = fields.find((/** @type {any[]} */ field) => field[0] === name)[2];
    const all = new Float64Array(this.memory.buffer, array.address + offset);
    const found = new Float64Array(count);
    for (let k = 0, at = 0; k < count; k++, at += (step * size) / SLOT) found[k] = all[at];
    return found;
  }

  /** Write numbers of a row. @param {string} row @param {Record<string, number>} values @param {number} count @returns {Room} */
  rows(row, values, count) {
    const { fields, size } = this.layouts.rows[row];
    const bytes = new Uint8Array(size * count);
    const view = new DataView(bytes.buffer);
    for (const [name, type, offset] of fields) {
      if (!(name in values)) continue;
      for (let k = 0; k < count; k++) {
        if (type === "<i8") view.setBigInt64(k * size + offset, BigInt(values[name]), true);
        else view.setFloat64(k * size + offset, values[name], true);
      }
    }
    return { shape: [count], bytes };
  }
}

/** Rows from `first` on of an array that is in memory. @param {Room} array @param {number} first @param {number} [end] @returns {Room} */
function part(array, first, end = array.shape[0]) {
  const stride = array.shape.slice(1).reduce((p, n) => p * n, /** @type {number} */ (array.size));
  const address = /** @type {number} */ (array.address) + first * stride;
  return { ...array, shape: [end - first, ...array.shape.slice(1)], address };
}

/** An array in memory without its first entries. @param {any} array @param {number} count @returns {any} */
const shifted = (array, count) => ({ ...array, address: array.address + count * array.size });

/** One row of an array, not a copy. @param {Room} array @param {number} row @returns {Room} */
const rowOf = (array, row) => ({ of: array, row, shape: array.shape.slice(1) });

/** All rows from `first` on. @param {Tree} rows @param {number} first @returns {Tree} */
function parts(rows, first) {
  const cut = (/** @type {any} */ one) => (Array.isArray(one) ? one.map((each) => part(each, first)) : part(one, first));
  return Object.fromEntries(Object.entries(rows).map(([name, one]) => [name, cut(one)]));
}

/** Scratch of a bearing. @param {Tree} constants @returns {Tree} */
function newWorkspace(constants) {
  const layers = constants.multiplicity.shape[0];
  const cells = constants.cells.capacity.shape[0];
  const ports = constants.lead_ports;
  const all = (/** @type {string} */ names, /** @type {number} */ n) =>
    Object.fromEntries(names.split(" ").map((name) => [name, room(n)]));
  return {
    duration: room(1),
    layers: all("elastic hysteretic force tangent trial direction slope flexibility", layers),
    cells: all("elimination pivot upper change", cells),
    lead_ports: { conductance: room(ports, ports), base: room(ports), flow: room(ports) },
    lead_modes: room(constants.lead_modes.shape[0]),
  };
}

/** Interpolation of equal intervals, linear. @param {Float64Array} values @param {number} dt @param {number} at */
function interpolated(values, dt, at) {
  const place = at / dt;
  const k = Math.min(Math.max(Math.floor(place + TINY), 0), values.length - 2);
  return values[k] + (values[k + 1] - values[k]) * Math.min(1, Math.max(0, place - k));
}

/** @param {Float64Array} values @returns {number} the largest magnitude */
const largest = (values) => values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
/** @param {Float64Array} values @returns {number} */
const highest = (values) => values.reduce((most, value) => Math.max(most, value), -Infinity);

/** One engine; `createEngine` makes it. */
export class Engine {
  /** @param {Kernels} kernels @param {any} data */
  constructor(kernels, data) {
    this.kernels = kernels;
    this.data = data;
    this.library = Object.fromEntries(Object.entries(data.bearings).map(([name, bearing]) =>
      [name, { ...bearing, base: name, changed: [], constants: decoded(bearing.constants) }]));
    this.bearings = Object.values(this.library);
    this.structures = Object.fromEntries(Object.entries(data.structures).map(([name, one]) =>
      [name, { ...one, system: decoded(one.system), motion: decoded(one.motion) }]));
    this.motions = Object.fromEntries(Object.entries(data.motions).map(([name, one]) =>
      [name, { ...one, acceleration_mm_s2: numbers(decoded(one.acceleration_mm_s2)) }]));
  }

  /** The digest of the sources of the module. @returns {string} */
  get sources() {
    const at = this.kernels.faces.thermobearing_sources.value;
    const bytes = new Uint8Array(this.kernels.memory.buffer, at);
    return String.fromCharCode(...bytes.slice(0, bytes.indexOf(0)));
  }

  /**
   * A bearing of the data, or one with other numbers, which needs a model with default options.
   * @param {{base: string} & Record<string, any>} changes numbers by their key in the file
   * @returns {{ok: true, bearing: any} | {ok: false, errors: any[]}}
   */
  bearing({ base, ...changes }) {
    const known = this.library[base];
    if (!known) return { ok: false, errors: [{ field: "base", value: base, message: `base = "${base}": no such bearing` }] };
    const changed = Object.keys(changes).filter((path) => changes[path] !== known.values[path]);
    const errors = changed.flatMap((path) => this.faults(known, path, changes[path]));
    if (errors.length) return { ok: false, errors };
    if (!changed.length) return { ok: true, bearing: known };
    const values = { ...known.values, ...changes };
    const sizes = planSizes(known, values);
    const joint = this.jointFaults(values, sizes);
    if (joint.length) return { ok: false, errors: joint };
    return { ok: true, bearing: this.built(known, values, sizes, changed) };
  }

  /** What `check` refuses of one number. @param {any} known @param {string} path @param {any} value @returns {any[]} */
  faults(known, path, value) {
    const field = this.data.fields[path];
    if (!field || !(path in known.values)) return [{ field: path, value, message: `${path}: not a number that can be changed` }];
    const { low = -Infinity, high = Infinity } = field;
    const inside = Number.isFinite(value) && (field.low_open ? value > low : value >= low) &&
      (field.high_open ? value < high : value <= high) && (!field.integer || Number.isInteger(value));
    const thinnest = this.data.limits.thinnest_sealing;
    const thin = path === "geometry.sealing_plate_thickness" && value > 0 && value < thinnest;
    if (inside && !thin) return [];
    const message = thin ? `${path}: ${general(value)} mm must be 0 or at least ${thinnest} mm` :
      `${path} = ${value}: must be ${field.allowed}`;
    return [{ field: path, value, low, high, unit: field.unit, message }];
  }

  /** What `check` refuses of numbers together. @param {any} values @param {any} sizes @returns {any[]} */
  jointFaults(values, { area, leadArea }) {
    const { yield_strain: [earliest, latest], modulus_MPa: [softest, hardest] } = this.data.limits;
    const thickness = values["geometry.rubber_thickness"];
    const yielding = values["hysteresis.yield_displacement"] / thickness;
    const modulus = (1e3 * values["hysteresis.layer_stiffness"] * thickness) / area;
    const found = [];
    if (leadArea >= area) {
      found.push({ field: "lead.diameter", value: values["lead.diameter"],
        message: `the lead cores have an area of ${general(leadArea)} mm2, the plan only ${general(area)} mm2` });
    }
    if (!(yielding >= earliest && yielding <= latest)) {
      found.push({ field: "hysteresis.yield_displacement", value: values["hysteresis.yield_displacement"],
        message: `hysteresis.yield_displacement and geometry.rubber_thickness give a yield strain of ${general(yielding, 3)}: must be ${earliest} to ${latest}` });
    }
    if (!(modulus >= softest && modulus <= hardest)) {
      found.push({ field: "hysteresis.layer_stiffness", value: values["hysteresis.layer_stiffness"],
        message: `hysteresis.layer_stiffness, plan and rubber_thickness give a shear modulus K_r t_r / A of ${general(modulus, 3)} MPa: must be ${softest} to ${hardest} MPa` });
    }
    return found;
  }

  /** Constants of other numbers, by the kernels of core/numbers.py. @param {any} known @param {any} values @param {any} sizes @param {string[]} changed @returns {any} */
  built(known, values, sizes, changed) {
    const { kernels } = this;
    kernels.begin();
    const given = known.given;
    const stack = this.stackOf(known, values, sizes);
    const law = Object.fromEntries(Object.entries(this.data.layer_law).map(([name, path]) => [name, values[path]]));
    law.scragging_strain = given.scragging_strain ?? 1;
    const [elastic, hysteretic, m, n, hardening, perYield, unloading, scragging] = kernels.call("core.numbers.rubber_numbers", law);
    const before = known.constants;
    const constants = {
      ...before,
      rubber: {
        ...before.rubber,
        layer_count: values["geometry.rubber_layers"],
        layer_share: 1 / values["geometry.rubber_layers"],
        elastic_stiffness: elastic,
        hysteretic_stiffness: hysteretic,
        elastic_exponent: m,
        hysteretic_exponent: n,
        hardening,
        yield_displacement: values["hysteresis.yield_displacement"],
        per_yield_displacement: perYield,
        unloading_curvature: unloading,
        scragging_displacement: scragging,
      },
      multiplicity: stack.multiplicity,
      layer_cells: stack.layer_cells,
      cells: stack.cells,
      source_rise: kernels.call("core.numbers.source_rise", given.rubber_heat, sizes.area - sizes.leadArea, law.thickness)[0],
    };
    if ("rate.stiffness" in values) {
      const stiffness = values["rate.stiffness"];
      constants.viscous = { ...before.viscous, stiffness, relaxation: values["rate.damping"] / stiffness };
    }
    let longest = known.longest_rest_step;
    if (sizes.leadArea > 0) {
      constants.lead = this.leadOf(known, values, stack);
      if (changed.some((path) => path.startsWith("geometry.") || path === "lead.cores" || path === "lead.diameter")) {
        Object.assign(constants, this.networkOf(known, values, sizes.area, stack));
        [longest] = kernels.call("core.lead_ends.longest_rest_step", constants);
      }
    }
    return {
      ...known,
      changed,
      values,
      constants,
      area_mm2: sizes.area,
      rubber_thickness_mm: values["geometry.rubber_layers"] * values["geometry.rubber_thickness"],
      stack: stack.shown,
      longest_rest_step: longest,
    };
  }

  /** Cells and layers. @param {any} known @param {any} values @param {any} sizes @returns {any} */
  stackOf(known, values, { area, perimeter, leadArea }) {
    const { kernels } = this;
    const { given, cells: divided } = known;
    const heights = {
      layers: values["geometry.rubber_layers"],
      half: known.stack.half,
      end_plate: values["geometry.end_plate_thickness"],
      sealing_plate: values["geometry.sealing_plate_thickness"],
      rubber: values["geometry.rubber_thickness"],
      shim: values["geometry.shim_thickness"],
      end_plate_cells: divided.end_plate,
      sealing_plate_cells: divided.sealing_plate,
      rubber_cells: divided.rubber,
      shim_cells: divided.shim,
      plate_grading: divided.plate_grading,
      mass_above: false,
      mass_below: false,
    };
    const laid = (/** @type {number} */ cells, /** @type {number} */ layers) => ({
      part: room(cells), thickness: room(cells), interface: room(cells),
      layers: room(layers), multiplicity: room(layers),
    });
    const [count, layers] = kernels.call("core.numbers.lay_cells", heights, laid(0, 0));
    const cells = laid(count, layers);
    kernels.call("core.numbers.lay_cells", heights, cells);
    const heat = { thickness: cells.thickness, conductivity: room(count), volumetric_heat: room(count), area: room(count) };
    const beside = { height: room(count), touches_end: room(count) };
    const capacity = room(count);
    const fill = {
      steel_conductivity: given.steel_conductivity, steel_heat: given.steel_heat,
      rubber_conductivity: given.rubber_conductivity, rubber_heat: given.rubber_heat,
      area, lead_area: leadArea, fold: given.fold,
    };
    kernels.call("core.numbers.fill_cells", fill, cells.part, heat, capacity, beside);
    const thickness = kernels.read(cells.thickness);
    const [face] = kernels.call("core.numbers.face_conductance", given.eta, given.film, kernels.read(heat.conductivity)[0], thickness[0]);
    const rates = { to_previous: room(count), to_next: room(count), end_loss: room(count), side_loss: room(count) };
    kernels.call("core.numbers.conserve_heat", heat, perimeter, given.side_film, face, known.stack.half ? 0 : face, rates);
    const codes = Array.from(new BigInt64Array(kernels.memory.buffer, cells.part.address, count), Number);
    let depth = 0;
    const shown = {
      part: codes.map((code) => this.data.parts[code]),
      thickness_mm: Array.from(thickness),
      depth_mm: Array.from(thickness, (t) => { depth += t; return depth - 0.5 * t; }),
      half: known.stack.half,
    };
    const keep = (/** @type {Room} */ array) => this.kept(array);
    const touches = new Uint8Array(kernels.memory.buffer, beside.touches_end.address, count).slice();
    return {
      codes, touches, beside: kernels.read(beside.height), shown,
      multiplicity: keep(cells.multiplicity),
      layer_cells: keep(cells.layers),
      cells: {
        ...Object.fromEntries(Object.entries(rates).map(([name, array]) => [name, keep(array)])),
        capacity: keep(capacity),
        beside_lead: keep(beside.height),
      },
    };
  }

  /** An array of this run for later runs. @param {any} array @returns {Room} */
  kept(array) {
    const size = array.shape.reduce((/** @type {number} */ p, /** @type {number} */ n) => p * n, array.size);
    const bytes = new Uint8Array(this.kernels.memory.buffer, array.address, size).slice();
    return { shape: array.shape, bytes };
  }

  /** Numbers of the lead cores. @param {any} known @param {any} values @param {any} stack @returns {any} */
  leadOf(known, values, stack) {
    const { given, constants } = known;
    const core = {
      cores: values["lead.cores"], diameter: values["lead.diameter"], yield_stress: values["lead.yield_stress"],
      surface_ratio: given.surface_ratio, confined: given.confined, volumetric_heat: given.lead_heat,
      steel_conductivity: given.steel_conductivity, diffusivity: given.diffusivity,
    };
    const count = stack.codes.length;
    const [strength, capacity, clock, one, sides] = this.kernels.call("core.numbers.lead_numbers", core,
      wholes(stack.codes), floats(stack.beside), flags(stack.touches), given.fold, room(count), room(count));
    return {
      ...constants.lead, cores: core.cores, stiffness: values["lead.stiffness"], strength,
      softening: values["lead.softening"], capacity, clock_rate: clock, end_conductance: one, side_conductance: sides,
    };
  }

  /** How heat leaves the lead cores. @param {any} known @param {any} values @param {number} area @param {any} stack @returns {any} */
  networkOf({ given }, values, area, stack) {
    const { kernels } = this;
    const { room: shape, terms } = this.data.network;
    const thickness = stack.shown.thickness_mm;
    const [film] = kernels.call("core.numbers.film_at_face", given.eta, given.film, given.steel_conductivity, thickness[0]);
    const sizes = {
      ...given.lead_sizes,
      end_plate: values["geometry.end_plate_thickness"],
      sealing_plate: values["geometry.sealing_plate_thickness"],
      layer: values["geometry.rubber_thickness"],
      shim: values["geometry.shim_thickness"],
      radius: 0.5 * values["lead.diameter"],
      plan: Math.sqrt(area / values["lead.cores"] / Math.PI),
      film_above: film,
      film_below: film,
    };
    const [cells, modes] = [room(thickness.length), room(terms)];
    const [ports, heated, found] = kernels.call("model.lead_impedance.fill_network", sizes,
      wholes(stack.codes), floats(thickness), flags(stack.touches), room(...shape), cells, modes);
    return { lead_ports: ports, lead_cells: this.kept(part(cells, 0, heated)), lead_modes: this.kept(part(modes, 0, found)) };
  }

  /** A virgin bearing, or one on each of some lines of a structure. @param {Tree} constants @param {number} ambient @param {number} [lines] @returns {Tree} */
  newState(constants, ambient, lines) {
    const { kernels } = this;
    const layers = constants.multiplicity.shape[0];
    const cells = constants.cells.capacity.shape[0];
    /** @type {Record<string, number>} */
    const warm = constants.lead.cores > 0 ? { lead_temperature: ambient } : {};
    const n = lines ?? 1;
    const per = (/** @type {Room} */ one, /** @type {number[]} */ ...shape) =>
      ({ ...one, shape: lines === undefined ? shape : [lines, ...shape] });
    return {
      layers: per(kernels.rows("Layer", { virgin: 1 }, n * layers), layers),
      turns: per(room(), layers, constants.rubber.closed_loops ? this.data.start.turns : 0),
      temperature: per(floats(new Float64Array(n * cells).fill(ambient)), cells),
      branches: per(kernels.rows("Branches", { idle: this.data.start.idle, ...warm }, n), 1),
      ends: per(room(), constants.lead_modes.shape[0]),
      response: per(kernels.rows("BearingResponse", warm, n), 1),
    };
  }

  /** Displacements and time steps of a test, one entry a segment. @param {any} test @param {any} bearing @returns {any[]} */
  segments(test, bearing) {
    const rubber = bearing.rubber_thickness_mm;
    const dt = test.dt_s ?? 0.005;
    let at = 0;
    return (test.steps ?? [test]).flatMap((/** @type {any} */ step) => {
      if ("rest_s" in step || "rest_within_K" in step) return [restSegment(step, dt, at, bearing.longest_rest_step ?? Infinity)];
      at = 0;
      return cycleSegments(step, rubber, dt);
    });
  }

  /**
   * A cyclic test at one ambient temperature.
   * @param {{bearing: any, ambient: number, test: any}} given
   */
  cyclicTest({ bearing, ambient, test }) {
    const { kernels } = this;
    const { constants } = bearing;
    kernels.begin();
    const segments = this.segments(test, bearing);
    const layers = constants.multiplicity.shape[0];
    const cells = constants.cells.capacity.shape[0];
    const most = segments.reduce((sum, one) => sum + one.keep.reduce((n, k) => n + k, 0) + 1, 2);
    const rows = {
      response: room(most), rubber: room(most, layers), layer_displacement: room(most, 0),
      hysteretic: room(most, 0), cells: room(most, cells),
    };
    const state = this.newState(constants, ambient);
    const [segment, cycle] = [new Int32Array(most), new Int32Array(most)];
    kernels.call("core.march.keep_row", constants, state, rows, 0);
    const run = { kept: 1, steps: 0, softened: 0, mismatch: 0, outcome: "completed" };
    for (const [number, one] of segments.entries()) {
      const spare = this.newState(constants, ambient);
      const path = {
        x: floats(one.x), dt: floats(one.dt), ambient: floats(new Float64Array(one.x.length).fill(ambient)),
        keep: flags(one.keep), settled: one.within,
      };
      const [done, kept, outcome, softened, mismatch] = kernels.call("core.march.march", constants,
        newWorkspace(constants), state, spare, path, parts(rows, run.kept));
      segment.fill(number, run.kept, run.kept + kept);
      let at = run.kept;
      for (let k = 0; k < done; k++) if (one.keep[k]) cycle[at++] = one.cycle[k];
      run.kept += kept;
      run.steps += done;
      run.softened += softened;
      run.mismatch = Math.max(run.mismatch, mismatch);
      if (!this.data.outcomes.good.includes(outcome)) run.outcome = this.data.outcomes.names[outcome];
      else if (!this.isPossible(constants, state, 0)) run.outcome = this.data.outcomes.not_physical;
      if (run.outcome !== "completed") break;
    }
    const ended = kernels.column("clock", state.response, 1)[0];
    if (kernels.column("clock", rows.response, run.kept)[run.kept - 1] !== ended) {
      kernels.call("core.march.keep_row", constants, state, rows, run.kept);
      [segment[run.kept], cycle[run.kept]] = [segment[run.kept - 1], cycle[run.kept - 1]];
      run.kept += 1;
    }
    return this.tested(bearing, rows, run, segments, segment.slice(0, run.kept), cycle.slice(0, run.kept));
  }

  /** @param {Tree} constants @param {Tree} state @param {number} before recoverable energy at the start */
  isPossible(constants, state, before) {
    const { coldest, hottest } = this.data.limits;
    const balanced = !constants.lead.published && constants.viscous.heats;
    return this.kernels.call("core.march.is_possible", state.temperature, state.response, before, coldest, hottest, balanced)[0] !== 0;
  }

  /** The result of a test. @param {any} bearing @param {Tree} rows @param {any} run @param {any[]} segments @param {Int32Array} segment @param {Int32Array} cycle */
  tested(bearing, rows, run, segments, segment, cycle) {
    const { kernels } = this;
    const { constants } = bearing;
    const count = run.kept;
    const response = Object.fromEntries(this.data.response.map((/** @type {any} */ one) =>
      [one.name, kernels.column(one.name, rows.response, count)]));
    const wide = rows.cells.shape[1];
    const hasLead = constants.lead.cores > 0;
    const result = {
      outcome: run.outcome,
      sentence: this.data.outcomes.sentences[run.outcome],
      steps: run.steps,
      softened: run.softened,
      mismatch_kN: run.mismatch,
      time: response.clock,
      displacement: response.displacement,
      force: response.force,
      segment,
      cycle,
      layers: { count: rows.rubber.shape[1], temperature: kernels.read(rows.rubber, count) },
      cells: { count: wide, temperature: new Float32Array(kernels.memory.buffer, rows.cells.address, wide * count).slice() },
      lead: hasLead ? response.lead_temperature : null,
      response,
    };
    return { ...result, cycles: this.cycles(bearing, segments, result) };
  }

  /** Measures of every closed cycle. @param {any} bearing @param {any[]} segments @param {any} result @returns {any[]} */
  cycles(bearing, segments, result) {
    const { displacement: x, force, segment, cycle, layers, response } = result;
    const found = [];
    for (let b = 1, a = 1; b <= x.length; b++) {
      if (b < x.length && segment[b] === segment[a] && cycle[b] === cycle[a]) continue;
      const about = segments[segment[a]];
      const low = x.subarray(a, b).reduce((/** @type {number} */ m, /** @type {number} */ v) => Math.min(m, v), 0);
      if (about.kind === "cycles" && cycle[a] > 0 && x[b - 1] === 0 && low < 0) {
        const work = response.work_in[b - 1] - response.work_in[a - 1];
        const [amplitude, modulus, damping, energy, stiffness, strength, postYield, highest, lowest] =
          this.kernels.call("results.loop.measure_loop", floats(x.subarray(a - 1, b)), floats(force.subarray(a - 1, b)),
            bearing.area_mm2, bearing.rubber_thickness_mm, work, true);
        found.push({
          segment: segment[a], cycle: cycle[a], strain: about.strain, amplitude_mm: amplitude, G_eq_MPa: modulus, h_eq: damping,
          energy_kN_mm: energy, stiffness_kN_mm: stiffness, characteristic_strength_kN: strength,
          post_yield_stiffness_kN_mm: postYield, force_max_kN: highest, force_min_kN: lowest,
          layer_temperature: Array.from(layers.temperature.subarray((b - 1) * layers.count, b * layers.count)),
          lead_temperature: result.lead ? result.lead[b - 1] : null,
        });
      }
      a = b;
    }
    return found;
  }

  /**
   * A structure on bearings under a ground motion.
   * @param {{bearing: any, ambient: number, motion: any, structure?: string, keepEvery?: number}} given
   */
  bridge({ bearing, ambient, motion, structure = Object.keys(this.structures)[0], keepEvery = 1 }) {
    const { kernels } = this;
    const { constants } = bearing;
    const pier = this.structures[structure];
    kernels.begin();
    const record = typeof motion === "string" ? this.motions[motion] : motion;
    const samples = Float64Array.from(record.acceleration_mm_s2);
    const dt = record.dt_s / Math.max(1, Math.ceil(record.dt_s / pier.dt_s - TINY));
    const steps = Math.round((record.dt_s * (samples.length - 1)) / dt);
    const ground = Float64Array.from({ length: steps + 1 }, (_, k) => interpolated(samples, record.dt_s, k * dt));
    const keep = Uint8Array.from({ length: steps }, (_, k) => Number((k + 1) % keepEvery === 0 || k === steps - 1));
    const count = 1 + keep.reduce((n, one) => n + one, 0);
    const n = pier.system.load.shape[0];
    const layers = constants.multiplicity.shape[0];
    const lines = pier.system.lines.shape[0];
    const [work, states] = [newWorkspace(constants), this.newState(constants, ambient, lines)];
    const kind = {
      constants, lines: wholes(Array.from({ length: lines }, (_, b) => b)), durations: room(lines), states,
      bearings: Array.from({ length: lines }, (_, b) => ({
        work: { ...work, layers: { ...work.layers, elastic: room(layers), hysteretic: room(layers) } },
        state: Object.fromEntries(Object.entries(states).map(([name, one]) => [name, rowOf(one, b)])),
        trial: this.newState(constants, ambient),
      })),
    };
    const rows = {
      energies: room(count), q: room(count, n), v: room(count, n), a: room(count, n),
      hinges: room(count, pier.system.hinges.shape[0]), bearings: room(count, lines),
      devices: room(count, pier.system.devices.devices.shape[0]),
      layers: [room(count, lines, layers)], cells: [room(count, lines, 0)],
    };
    const peaks = { places: room(0, n), carried: room(0), watches: room(0), lines: room(0), hinges: room(0) };
    kernels.call("structure.newmark.start_motion", pier.system, pier.motion, ground[0]);
    kernels.call("structure.forces.keep_motion", [kind], pier.motion, rows, 0);
    const shaking = { ground: floats(ground), dt, ambient: floats(new Float64Array(steps).fill(ambient)), keep: flags(keep) };
    const [done, kept, ended] = kernels.call("structure.newmark.newmark_march", pier.system, [kind], pier.motion,
      pier.scheme, shaking, parts(rows, 1), peaks);
    return this.shaken({ bearing, pier, rows, kind, ground, keep, done, kept: kept + 1, ended });
  }

  /** The result of a bridge. @param {any} given */
  shaken({ bearing, pier, rows, kind, ground, keep, done, kept, ended }) {
    const { kernels } = this;
    const { constants } = bearing;
    const lines = rows.bearings.shape[1];
    const q = kernels.read(rows.q, kept);
    const n = rows.q.shape[1];
    const along = (/** @type {number[]} */ weights) => {
      const sums = new Float64Array(kept);
      for (let k = 0; k < kept; k++) for (let i = 0; i < n; i++) sums[k] += weights[i] * q[k * n + i];
      return sums;
    };
    const rubber = bearing.rubber_thickness_mm;
    const { line } = pier; // that is reported, of all whose peaks are
    const column = (/** @type {string} */ name, /** @type {number} */ b = line) =>
      kernels.column(name, shifted(rows.bearings, b), kept, lines);
    const each = Array.from({ length: lines }, (_, b) => b);
    const most = (/** @type {string} */ name) => Math.max(...each.map((b) => largest(column(name, b))));
    const displacement = column("displacement");
    const hinges = rows.hinges.shape[1];
    const bend = (/** @type {string} */ name, /** @type {number | null} */ h = pier.hinge) => h === null ? null :
      kernels.column(name, shifted(rows.hinges, h), kept, hinges);
    const rotation = bend("rotation");
    const yielding = pier.hinge === null ? NaN : pier.yield_rotations[pier.hinge];
    const strain = displacement.map((d) => d / rubber);
    const moved = along(pier.top.map((/** @type {number} */ top, /** @type {number} */ i) => top - pier.base[i]));
    const places = new Float64Array(kept);
    for (let k = 0, at = 1; k < keep.length && at < kept; k++) if (keep[k]) places[at++] = k + 1;
    const layerWidth = rows.layers[0].shape[2];
    const temperature = kernels.read(part(rows.layers[0], 0), kept);
    const first = lines === 1 ? temperature : temperature.filter((_, k) => Math.floor(k / layerWidth) % lines === line);
    const turned = pier.yield_rotations.map((/** @type {number} */ one, /** @type {number} */ h) => largest(/** @type {Float64Array} */ (bend("rotation", h))) / one);
    const hinged = pier.piers.filter((/** @type {any} */ one) => one.hinge !== null).map((/** @type {any} */ one) => turned[one.hinge]);
    const peaks = {
      bearing_strain: most("displacement") / rubber, bearing_displacement_mm: most("displacement"), bearing_force_kN: most("force"),
      pier_ductility: hinged.length ? Math.max(...hinged) : NaN,
      pier_moment_kN_m: hinged.length ? Math.max(...pier.piers.filter((/** @type {any} */ one) => one.hinge !== null).map((/** @type {any} */ one) => largest(/** @type {Float64Array} */ (bend("moment", one.hinge))))) / 1e3 : NaN,
      pier_displacement_mm: Math.max(...pier.piers.map((/** @type {any} */ one) => largest(along(one.moved)))),
      layer_temperature_degC: highest(temperature),
      lead_temperature_degC: constants.lead.cores > 0 ? Math.max(...each.map((b) => highest(column("lead_temperature", b)))) : NaN,
    };
    const [damped, entered] = ["damping", "input"].map((name) => kernels.column(name, rows.energies, kept)[kept - 1]);
    const outcome = this.judged({ kind, rows, ended, constants, pier, strain: peaks.bearing_strain, ductility: Math.max(0, ...turned), along });
    return {
      outcome,
      sentence: this.data.outcomes.sentences[outcome],
      steps: done,
      damping_of_input: damped / Math.max(entered, this.data.limits.least_energy),
      time: kernels.column("clock", rows.energies, kept),
      ground: places.map((k) => ground[k]),
      bearing: {
        displacement_mm: displacement, strain, force_kN: column("force"),
        layer_temperature: first, layers: layerWidth, lead: constants.lead.cores > 0 ? column("lead_temperature") : null,
      },
      pier: {
        displacement_mm: moved, rotation, moment_kN_m: bend("moment")?.map((m) => m / 1e3) ?? null,
        ductility: rotation?.map((r) => r / yielding) ?? null, deck_mm: along(pier.deck),
      },
      peaks,
    };
  }

  /** Whether the model holds as far as the run went. @param {any} given @returns {string} */
  judged({ kind, rows, ended, constants, pier, strain, ductility, along }) {
    const { names, not_physical: impossible, pier_beyond_limit: beyond } = this.data.outcomes;
    if (names[ended] !== "completed") return names[ended];
    const before = this.kernels.column("recoverable", rows.bearings, rows.bearings.shape[1]);
    for (const [b, energy] of before.entries()) {
      const of = (/** @type {Room} */ array) => ({ ...part(array, b, b + 1), shape: array.shape.slice(1) });
      const state = { temperature: of(kind.states.temperature), response: of(kind.states.response) };
      if (!this.isPossible(constants, state, energy)) return impossible;
    }
    if (strain > this.data.limits.strain) return impossible;
    const drift = pier.piers.map((/** @type {any} */ one) => largest(along(one.moved)) / one.height_mm);
    if (ductility > pier.limits.ductility || Math.max(...drift) > pier.limits.drift) return beyond;
    return "completed";
  }
}

/** A number as the messages of Python have it, "%.6g". @param {number} number @param {number} [digits] */
function general(number, digits = 6) {
  const [mantissa, power] = number.toExponential(digits - 1).split("e");
  if (number !== 0 && (Number(power) < -4 || Number(power) >= digits)) {
    return `${Number(mantissa)}e${power[0]}${power.slice(1).padStart(2, "0")}`;
  }
  return String(Number(number.toPrecision(digits)));
}

/** Gross area and perimeter of a plan, and area of lead. @param {any} known @param {any} values */
function planSizes(known, values) {
  const { share, sizes } = known.plan;
  const along = values[sizes[0]];
  const across = values[sizes[sizes.length - 1]];
  const cores = values["lead.cores"] ?? 0;
  return {
    area: share * (along * across),
    perimeter: share * (2 * (along + across)),
    leadArea: cores ? cores * Math.PI * (0.5 * values["lead.diameter"]) ** 2 : 0,
  };
}

/** @param {any} step @param {number} rubber @param {number} dt @returns {any[]} */
function cycleSegments(step, rubber, dt) {
  const size = step.amplitude_mm ?? step.strain * rubber;
  const speed = step.frequency_hz ? 4 * size * step.frequency_hz : (step.speed_mm_s ?? 30);
  const found = [oneAmplitude(size, step.cycles ?? 3, speed, step.wave ?? "triangle", dt, size / rubber, "cycles")];
  if (step.closing_strain) found.push(oneAmplitude(step.closing_strain * rubber, 1, speed, step.wave ?? "triangle", dt, step.closing_strain, "closing cycle"));
  return found;
}

/** @param {number} size @param {number} count @param {number} speed @param {string} wave @param {number} dt @param {number} strain @param {string} kind */
function oneAmplitude(size, count, speed, wave, dt, strain, kind) {
  const quarter = size / speed;
  const steps = Math.max(FEWEST_STEPS, Math.ceil(quarter / dt - TINY));
  const shape = Array.from({ length: 4 * steps }, (_, k) => {
    const place = k + 1;
    const leg = Math.floor(k / steps);
    const rising = leg % 2 === 0 ? place - leg * steps : (leg + 1) * steps - place;
    const value = wave === "sine" ? Math.sin((0.5 * Math.PI * rising) / steps) : rising / steps;
    return rising === 0 ? 0 : leg < 2 ? value : -value;
  });
  const x = Float64Array.from({ length: 4 * steps * count }, (_, k) => size * shape[k % (4 * steps)]);
  return {
    kind, strain, within: 0, x, dt: new Float64Array(x.length).fill(quarter / steps), keep: new Uint8Array(x.length).fill(1),
    cycle: Int32Array.from(x, (_, k) => (kind === "cycles" ? 1 + Math.floor(k / (4 * steps)) : 0)),
  };
}

/** @param {any} step @param {number} dt @param {number} at @param {number} piece longest step of a rest with lead */
function restSegment(step, dt, at, piece) {
  const span = step.rest_s ?? SETTLE_LIMIT;
  const longest = Math.max(dt, Math.min(span / REST_STEPS, LONGEST_REST_STEP));
  const sizes = [Math.min(dt, span, REST_START)];
  for (let left = span - sizes[0]; left > 0;) {
    let size = Math.min(sizes[sizes.length - 1] * REST_GROWTH, longest);
    if (left < 1.5 * size) size = left;
    sizes.push(size);
    left -= size;
  }
  const cut = sizes.map((size) => Math.max(1, Math.ceil(size / piece)));
  const dts = sizes.flatMap((size, k) => Array(cut[k]).fill(size / cut[k]));
  const keep = cut.flatMap((n) => [...Array(n - 1).fill(0), 1]);
  return {
    kind: "rest", strain: 0, within: step.rest_within_K ?? 0, x: new Float64Array(dts.length).fill(at),
    dt: Float64Array.from(dts), keep: Uint8Array.from(keep), cycle: new Int32Array(dts.length),
  };
}

/**
 * @param {BufferSource} wasm the module of `live_module()`
 * @param {any} data of `live_data()`
 * @returns {Promise<Engine>}
 */
export async function createEngine(wasm, data) {
  const heap = Math.ceil((wasm.byteLength + STACK) / PAGE) * PAGE;
  const memory = new WebAssembly.Memory({ initial: heap / PAGE + 64 });
  const { exp, expm1, pow, sin, cos, tan, tanh, atan, atanh } = Math;
  const env = { memory, exp, expm1, pow, sin, cos, tan, tanh, atan, atanh, __multi3: multiply128(memory) };
  const { instance } = await WebAssembly.instantiate(wasm, { env });
  const engine = new Engine(new Kernels(instance, memory, heap, data.kernels), data);
  if (engine.sources !== data.sources) throw new Error("The module and the data were built from other sources.");
  return engine;
}
