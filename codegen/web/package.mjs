// SPDX-License-Identifier: BSD-3-Clause
// Calls a generated package that was compiled to WebAssembly by softimpact.codegen.wasm.
//
//     const panda = await load(bytes);
//     const p = { ...panda.default_params(), joint_stiffness: Array(7).fill(3000) };
//     const region = panda.body_region({ part: panda.enums.body_part.CHEST, clamped: 1 });
//     const { status, speed } = panda.safe_speed({ q, n, limit: region.force_limit, region, p });
//
// A law of contact is an array of rows. A function takes its C arguments by name and returns what it writes, with `status` beside it;
// matrices are arrays of rows. Where it writes nothing the result holds nothing but the status.

const SECTION = "softimpact";

/** Return a package from the bytes of a .wasm file. */
export async function load(bytes) {
  return instantiate(await WebAssembly.compile(bytes));
}

/** Return a package from a compiled module; each call of this has memory of its own. */
export function instantiate(module) {
  const [section] = WebAssembly.Module.customSections(module, SECTION);
  if (!section) throw new Error("not a package that softimpact compiled to WebAssembly");
  const about = JSON.parse(new TextDecoder().decode(section));
  const { exports } = new WebAssembly.Instance(module, {});
  exports._initialize();
  const calls = Object.entries(about.entries).map(([name, entry]) => [
    name,
    (given = {}) => call(about, exports, name, entry, given),
  ]);
  const tables = Object.entries(about.tables).map(([name, table]) => {
    const at = exports[`${about.prefix}_${name}`].value;
    return [name, shaped(read(about, exports.memory, table.type, at, count(table.shape)), table.shape)];
  });
  const { fill_params: fill, ...entries } = Object.fromEntries(calls);
  return Object.freeze({
    ...entries,
    ...Object.fromEntries(tables),
    ...(fill && { default_params: () => fill({ layout: about.layout }) }),
    enums: about.enums,
    numbers: about.numbers,
    texts: about.texts,
    structs: about.structs,
  });
}

function call(about, exports, name, entry, given) {
  for (const key of Object.keys(given)) {
    if (!entry.arguments.some((a) => a.name === key && !a.written)) {
      throw new TypeError(`${name} takes no ${key}`);
    }
  }
  const { memory } = exports;
  let end = exports.__heap_base.value;
  const place = (size) => {
    const at = (end + 7) & ~7;
    end = at + size;
    const missing = end - memory.buffer.byteLength;
    if (missing > 0) memory.grow(Math.ceil(missing / 65536));
    return at;
  };
  const results = [];
  const passed = entry.arguments.map((argument) => {
    if (argument.written) {
      const at = place(sizeOf(about, argument.type) * count(argument.shape));
      results.push([argument, at]);
      return at;
    }
    const value = given[argument.name];
    if (!argument.pointer) return number(value, argument.name);
    if (value === undefined || value === null) return 0; // C says what it makes of NULL
    return write(about, memory, place, argument, value);
  });
  const returned = exports[`${about.prefix}_${name}`](...passed);
  if (entry.returns === "const char *") return text(memory, returned);
  const found = { status: returned };
  if (!about.written.includes(returned)) return found;
  for (const [argument, at] of results) {
    const struct = about.structs[argument.type];
    if (struct) Object.assign(found, readStruct(about, memory, struct, at));
    else {
      const values = read(about, memory, argument.type, at, count(argument.shape));
      found[argument.name] = shaped(values, argument.shape);
    }
  }
  return found;
}

const count = (shape) => shape.reduce((product, size) => product * size, 1);

const sizeOf = (about, type) => about.structs[type]?.size ?? about.sizes[type];

function number(value, name) {
  if (typeof value !== "number") throw new TypeError(`${name} must be a number, not ${value}`);
  return value;
}

function view(about, memory, type, at, length) {
  const kind = { 8: Float64Array, 1: Uint8Array }[about.sizes[type]];
  const four = { real: Float32Array, "unsigned int": Uint32Array }[type] ?? Int32Array;
  return new (kind ?? four)(memory.buffer, at, length);
}

function read(about, memory, type, at, length) {
  return Array.from(view(about, memory, type, at, length));
}

function shaped(values, shape) {
  if (shape.length === 0) return values[0];
  if (shape.length === 1) return values;
  const size = count(shape.slice(1));
  return Array.from({ length: shape[0] }, (_, i) =>
    shaped(values.slice(i * size, (i + 1) * size), shape.slice(1)),
  );
}

function readStruct(about, memory, struct, at) {
  return Object.fromEntries(
    struct.fields.map(({ name, type, shape, offset, pointer }) => [
      name,
      // what is written holds no address but NULL
      pointer ? null : shaped(read(about, memory, type, at + offset, count(shape)), shape),
    ]),
  );
}

function write(about, memory, place, argument, value) {
  const struct = about.structs[argument.type];
  if (!struct) {
    const numbers = flat(value, argument.name);
    const [first, ...rest] = argument.shape;
    const fits = first === null ? numbers.length % count(rest) === 0 : numbers.length === count(argument.shape);
    if (argument.shape.length > 0 && !fits) {
      throw new TypeError(`${argument.name} must hold ${argument.shape.join("×")} numbers, not ${numbers.length}`);
    }
    const at = place(sizeOf(about, argument.type) * numbers.length);
    view(about, memory, argument.type, at, numbers.length).set(numbers);
    return at;
  }
  const at = place(struct.size);
  for (const { name, type, shape, offset, pointer } of struct.fields) {
    const numbers = flat(value[name], `${argument.name}.${name}`);
    if (pointer) {
      // rows of numbers; none is NULL
      const rows = numbers.length === 0 ? 0 : place(about.sizes.real * numbers.length);
      if (rows) view(about, memory, "real", rows, numbers.length).set(numbers);
      view(about, memory, "unsigned int", at + offset, 1)[0] = rows;
      continue;
    }
    if (numbers.length !== count(shape)) {
      throw new TypeError(`${argument.name}.${name} must hold ${count(shape)} numbers, not ${numbers.length}`);
    }
    view(about, memory, type, at + offset, numbers.length).set(numbers);
  }
  return at;
}

function flat(value, name) {
  const numbers = typeof value === "number" ? [value] : Array.from(value ?? []).flat();
  numbers.forEach((x) => number(x, name));
  return numbers;
}

function text(memory, at) {
  const bytes = new Uint8Array(memory.buffer, at);
  return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
}
