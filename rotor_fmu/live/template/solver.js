// The solver library as WebAssembly, and a run of it: in a worker of the page, and in Node for tests.

const FEW = 20;
const STATUS = { WARNING: 1 };
const CALL = {
  Real: "fmi2SetReal",
  Integer: "fmi2SetInteger",
  Boolean: "fmi2SetBoolean",
  Enumeration: "fmi2SetInteger",
};

// An instance of a machine. wasm, table: bytes; log: is handed each message with its status.
async function instanceOf(wasm, table, log) {
  let memory = null;
  const textAt = (at) => {
    const bytes = new Uint8Array(memory.buffer);
    return new TextDecoder().decode(bytes.slice(at, bytes.indexOf(0, at)));
  };
  // What the C library asks of a system: there are no files, and what is printed is logged anyway.
  const system = {
    fd_write(file, list, count, written) {
      const view = new DataView(memory.buffer);
      let bytes = 0;
      for (let i = 0; i < count; i++) bytes += view.getUint32(list + 8 * i + 4, true);
      view.setUint32(written, bytes, true);
      return 0;
    },
    proc_exit(status) {
      throw new Error(`the solver ended with status ${status}`);
    },
  };
  const BAD_FILE = 8;
  const imports = {
    page: { log_message: (environment, status, message) => log(status, textAt(message)) },
    wasi_snapshot_preview1: new Proxy(system, { get: (of, name) => of[name] ?? (() => BAD_FILE) }),
  };
  const { instance } = await WebAssembly.instantiate(wasm, imports);
  const library = instance.exports;
  memory = library.memory;
  library._initialize();
  const place = library.malloc(table.length);
  new Uint8Array(memory.buffer).set(table, place);
  const handle = library.page_instantiate(place, table.length);
  if (!handle) throw new Error("the machine cannot be instantiated");
  return { library, handle, memory };
}

// Room for `references` and as many values of `size` bytes.
function room(solver, references, size) {
  const at = solver.library.malloc((4 + size) * references.length + 8);
  new Uint32Array(solver.memory.buffer, at, references.length).set(references);
  const values = (at + 4 * references.length + 7) & ~7;
  return { at, values, count: references.length };
}

function setValue(solver, { reference, kind, value }) {
  const { at, values } = room(solver, [reference], 8);
  const view = new DataView(solver.memory.buffer);
  if (kind === "Real") view.setFloat64(values, value, true);
  else view.setInt32(values, Number(value), true);
  const status = solver.library[CALL[kind]](solver.handle, at, 1, values);
  solver.library.free(at);
  return status;
}

// A run: yields rows of time and what is recorded, many in one array, and returns "" or a reason.
// The first of them are few, so that a picture is there soon.
// plan: values { reference, kind, value } to set before; drive, the speed's reference; legs of the
// course of the speed, each { steps, step, from, rate }; record, references.
function* runOf(solver, plan, messages, chunk) {
  const { library, handle } = solver;
  const failed = (status) => status > STATUS.WARNING;
  const reason = () => messages.at(-1) ?? "the solver gave no reason";
  if (plan.values.some((each) => failed(setValue(solver, each)))) return reason();
  const begun =
    failed(library.fmi2SetupExperiment(handle, 0, 0, 0, 0, 0)) ||
    failed(library.fmi2EnterInitializationMode(handle)) ||
    failed(library.fmi2ExitInitializationMode(handle));
  if (begun) return reason();
  const read = room(solver, plan.record, 8);
  const drive = room(solver, [plan.drive], 16);
  const order = library.malloc(4);
  const width = 1 + plan.record.length;
  let rows = new Float64Array(chunk * width);
  let used = 0;
  const record = (t) => {
    library.fmi2GetReal(handle, read.at, read.count, read.values);
    rows[used * width] = t;
    rows.set(new Float64Array(solver.memory.buffer, read.values, read.count), used * width + 1);
    used += 1;
  };
  record(0);
  let begin = 0;
  let isFirst = true;
  for (const { steps, step, from, rate } of plan.legs) {
    for (let i = 0; i < steps; i++) {
      const t = begin + i * step;
      const view = new DataView(solver.memory.buffer);
      view.setFloat64(drive.values, from + rate * i * step, true);
      view.setFloat64(drive.values + 8, rate, true);
      view.setInt32(order, 1, true);
      const status =
        library.fmi2SetReal(handle, drive.at, 1, drive.values) ||
        library.fmi2SetRealInputDerivatives(handle, drive.at, 1, order, drive.values + 8) ||
        library.fmi2DoStep(handle, t, step, 1);
      if (failed(status)) {
        if (used) yield rows.slice(0, used * width);
        return reason();
      }
      record(t + step);
      if (used === chunk || (isFirst && used === FEW)) {
        isFirst = false;
        yield rows.slice(0, used * width);
        rows = new Float64Array(chunk * width);
        used = 0;
      }
    }
    begin += steps * step;
  }
  if (used) yield rows.slice(0, used * width);
  return "";
}

// What the worker does with { wasm, table, plan }.
async function work({ wasm, table, plan }, post) {
  const messages = [];
  const log = (status, message) => {
    messages.push(message);
    if (status === STATUS.WARNING) post({ warning: message });
  };
  try {
    const run = runOf(await instanceOf(wasm, table, log), plan, messages, 200);
    for (let next = run.next(); ; next = run.next()) {
      if (next.done) return post({ end: next.value });
      post({ rows: next.value }, [next.value.buffer]);
    }
  } catch (error) {
    return post({ end: error.message });
  }
}
