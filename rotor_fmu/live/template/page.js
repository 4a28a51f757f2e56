// The page: controls, runs in a worker, pictures, link and CSV.

const field = (id) => document.getElementById(id);
const data = JSON.parse(field("data").textContent);
const controls = controlsOf(data);
const byName = new Map(controls.map((control) => [control.name, control]));
const columnOf = new Map(data.recorded.map((each, i) => [each.name, i]));
const values = {}; // SI units, by name, where they differ from the machine file's
const DRAW_AFTER = 120; // [ms]
const WAIT = 250; // between a change and its run [ms]

const make = (kind, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(kind), properties);
  element.append(...children);
  return element;
};

async function inflated(id) {
  const letters = atob(field(id).textContent);
  const bytes = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// --- controls ---------------------------------------------------------------------------------

const SLIDER_STEPS = 1000;

function shareOf({ low, high, log }, value) {
  if (log) return Math.log(Math.max(value, low) / low) / Math.log(high / low);
  return (value - low) / (high - low);
}

function valueAt({ low, high, log }, share) {
  const value = log ? low * (high / low) ** share : low + share * (high - low);
  const size = Math.max(Math.abs(low), Math.abs(high));
  return Math.abs(value) < 1e-9 * size ? 0 : Number(value.toPrecision(3));
}

const current = (control) => values[control.name] ?? control.start;

// Show a control's value in all of its fields.
function show(control) {
  const { input, range, row } = control;
  const value = current(control);
  const isChanged = control.name in values;
  if (control.kind === "Boolean") input.checked = Boolean(value);
  else if (control.choices.length) input.value = String(value);
  else if (control.unset && !isChanged) input.value = "";
  else input.value = digits(value * control.factor, 6);
  if (range) {
    range.value = Math.round(SLIDER_STEPS * shareOf(control.slider, value));
    range.setAttribute("aria-valuetext", `${digits(value * control.factor)} ${control.unit}`);
  }
  row.classList.toggle("changed", isChanged);
  if (isChanged) {
    for (let at = row; at; at = at.parentElement.closest("details")) at.open = true;
  }
}

function change(control, value) {
  if (value === control.start) delete values[control.name];
  else values[control.name] = value;
  show(control);
}

function rowOf(control, number) {
  const id = `c${number}`;
  const label = make("label", { htmlFor: id, textContent: control.text, title: control.about });
  const row = (control.row = make("div", { className: "control" }, label));
  let input;
  if (control.kind === "Boolean") {
    input = make("input", { type: "checkbox", id });
    input.addEventListener("change", () => change(control, Number(input.checked)));
  } else if (control.choices.length) {
    const options = control.choices.map((text, i) => make("option", { value: String(i), textContent: text }));
    input = make("select", { id }, ...options);
    input.addEventListener("change", () => change(control, Number(input.value)));
  } else {
    input = make("input", { type: "number", id, step: "any", required: !control.unset });
    if (control.unset) input.placeholder = "as preset";
    input.addEventListener("change", () => {
      if (input.value === "") change(control, control.start);
      else change(control, Number(input.value) / control.factor);
    });
  }
  control.input = input;
  row.append(input);
  if (!control.choices.length && control.kind !== "Boolean") {
    row.append(make("span", { className: "unit", textContent: control.unit }));
  }
  if (control.slider) {
    const range = make("input", { type: "range", min: 0, max: SLIDER_STEPS, step: 1 });
    range.setAttribute("aria-label", `${control.text}, ${control.unit}`);
    range.addEventListener("input", () => {
      change(control, valueAt(control.slider, range.value / SLIDER_STEPS));
    });
    row.append((control.range = range));
  }
  return row;
}

function buildControls() {
  controls.forEach(rowOf);
  field("course").append(...data.course.controls.map((control) => control.row));
  const isWide = matchMedia("(min-width: 901px)").matches;
  let open = 0;
  for (const group of data.groups) {
    const usual = group.controls.filter((control) => control.usual);
    const others = group.controls.filter((control) => !control.usual);
    const details = make("details", {}, make("summary", { textContent: group.title }));
    details.append(...usual.map((control) => control.row));
    const rest = others.map((control) => control.row);
    if (usual.length && rest.length) {
      details.append(make("details", {}, make("summary", { textContent: "more" }), ...rest));
    } else details.append(...rest);
    details.open = isWide && usual.length > 0 && open < 4;
    open += usual.length > 0;
    field("groups").append(details);
  }
  controls.forEach(show);
}

// --- the link ---------------------------------------------------------------------------------

function hash() {
  return new URLSearchParams(Object.entries(values).map(([n, v]) => [n, String(v)])).toString();
}

// Take what the address says; what it cannot mean is told.
function readHash() {
  const unread = [];
  for (const name of Object.keys(values)) delete values[name];
  if (!location.hash) Object.assign(values, data.given);
  for (const [name, text] of new URLSearchParams(location.hash.slice(1))) {
    const control = byName.get(name);
    const value = Number(text);
    if (control && text !== "" && Number.isFinite(value)) values[name] = value;
    else unread.push(`${name} = ${text}`);
  }
  for (const [name, value] of Object.entries(values)) change(byName.get(name), value);
  controls.forEach(show);
  return unread.map((each) => `The address has ${each}, which this machine does not know.`);
}

// --- runs -------------------------------------------------------------------------------------

let stored = null; // the solver's bytes and the machine's table
let worker = null;
let now = null;
let before = null;
let finished = 0;
let drawing = 0;
let waiting = 0;

function notice(text) {
  field("notices").append(make("p", { className: "notice", textContent: text }));
}

function halt() {
  worker?.terminate();
  worker = null;
  field("stop").disabled = true;
}

function begin(notes = []) {
  clearTimeout(waiting);
  halt();
  field("notices").replaceChildren();
  notes.forEach(notice);
  let plan;
  try {
    plan = planOf(data, values);
  } catch (error) {
    notice(error.message);
    field("state").textContent = "Not run.";
    return;
  }
  if (now?.isShown) before = now;
  const columns = data.recorded.map(() => new Float64Array(plan.rows));
  const given = { ...values };
  now = { plan, given, t: new Float64Array(plan.rows), columns, n: 0, isDrawn: false, isShown: false, begun: performance.now() };
  const run = now;
  const text = `${field("solver").textContent}
onmessage = ({ data }) => work(data, (message, moved) => postMessage(message, moved ?? []));`;
  const address = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
  worker = new Worker(address);
  URL.revokeObjectURL(address);
  worker.onmessage = ({ data: message }) => {
    if (message.warning) notice(message.warning);
    if (message.rows) take(run, message.rows);
    if (message.end !== undefined) end(run, message.end);
  };
  worker.onerror = (event) => end(run, event.message || "the solver did not start");
  worker.postMessage({ wasm: stored.wasm, table: stored.table, plan });
  field("stop").disabled = false;
  field("csv").disabled = true;
  history.replaceState(null, "", `#${hash()}`);
  say();
}

function take(run, rows) {
  const width = 1 + run.columns.length;
  for (let at = 0; at < rows.length; at += width) {
    run.t[run.n] = rows[at];
    for (let c = 0; c < run.columns.length; c++) run.columns[c][run.n] = rows[at + 1 + c];
    run.n += 1;
  }
  if (!drawing) drawing = setTimeout(redraw, run.isDrawn ? DRAW_AFTER : 0);
  run.isDrawn = true;
}

function end(run, failure) {
  halt();
  run.isShown = run.n > 0;
  run.seconds = (performance.now() - run.begun) / 1e3;
  run.failure = failure;
  field("csv").disabled = run.n === 0;
  if (failure) notice(`The run ended early: ${failure}`);
  redraw();
  finished += 1;
  document.documentElement.dataset.runs = finished;
}

function later() {
  clearTimeout(waiting);
  if (field("auto").checked) waiting = setTimeout(begin, WAIT);
}

// --- pictures ---------------------------------------------------------------------------------

const charts = {
  amplitude: new Chart("amplitude", (hz) => pickWhere(abscissa(now), hz)),
  orbit: new Chart("orbit"),
  time: new Chart("time", (t) => pickWhere(now.t.subarray(0, now.n), t)),
  near: new Chart("near", (t) => pickWhere(now.t.subarray(0, now.n), t)),
};
let picked = null; // a time [s], null where none was picked

const column = (run, name) => run.columns[columnOf.get(name)].subarray(0, run.n);
const isSteady = (run) => run.plan.speeds[0] === run.plan.speeds[1];
const shownRuns = () => (field("compare").checked && before ? [before, now] : [now]);
const styleOf = (run) => (run === now ? "now" : "before");
const wordOf = (run) => (run === now ? "this run" : "the run before");
const scaled = (list, factor) => list.map((value) => value * factor);

function abscissa(run) {
  return isSteady(run) ? run.t.subarray(0, run.n) : scaled(column(run, "w"), 1 / TURN);
}

function amplitude(run, place) {
  if (place.amplitude) return scaled(column(run, place.amplitude), 1e6);
  const [x, y] = [column(run, place.x), column(run, place.y)];
  return x.map((value, i) => 1e6 * Math.hypot(value, y[i]));
}

// Index of the last row at or before a time.
function rowAt(run, t) {
  let [low, high] = [0, run.n - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (run.t[middle] <= t * (1 + 1e-12)) low = middle;
    else high = middle - 1;
  }
  return low;
}

function pickWhere(list, value) {
  let best = 0;
  for (let i = 1; i < list.length; i++) {
    if (Math.abs(list[i] - value) < Math.abs(list[best] - value)) best = i;
  }
  pick(now.t[best]);
}

function pick(t) {
  picked = t;
  field("cursor").value = Math.round((1000 * t) / now.plan.duration);
  redraw();
}

// Rows of so many turns up to a row.
function turnsUpTo(run, row, turns) {
  const phi = column(run, "phi");
  let first = row;
  while (first > 0 && Math.abs(phi[row] - phi[first]) < turns * TURN) first -= 1;
  return [first, row + 1];
}

// Row of the largest amplitude.
function peakRow(run, place) {
  return amplitude(run, place).reduce((best, value, i, list) => (value > list[best] ? i : best), 0);
}

function peakOf(run, place) {
  const row = peakRow(run, place);
  return `${digits(amplitude(run, place)[row], 4)} µm at ${digits(hertz(run, row), 4)} Hz`;
}

// Zero where round-off alone is left of the speed.
function hertz(run, row) {
  const w = column(run, "w")[row];
  return Math.abs(w) < 1e-9 * Math.max(...run.plan.speeds.map(Math.abs)) ? 0 : w / TURN;
}

// The time picked; without one the last, and the peak's of a run that has ended.
function shownTime(place) {
  if (picked !== null) return picked;
  return now.t[place && now.seconds !== undefined ? peakRow(now, place) : now.n - 1];
}

function say() {
  const share = now.n / now.plan.rows;
  field("progress").value = share;
  const place = data.places[field("place").value];
  let text = `Running: ${digits(now.n ? now.t[now.n - 1] : 0, 3)} of ${digits(now.plan.duration, 4)} s.`;
  if (now.seconds !== undefined) {
    const how = now.failure ? "Ended early" : "Done";
    text = `${how} after ${digits(now.seconds, 2)} s.`;
    if (now.n && place) {
      text += ` Peak of ${place.title}: ${peakOf(now, place)}`;
      if (shownRuns().length > 1) text += `; the run before: ${peakOf(before, place)}`;
      text += ".";
    }
  }
  // read aloud when a run has ended, not ten times a second
  for (const id of ["state", "reading"]) {
    field(id).setAttribute("aria-live", now.seconds === undefined ? "off" : "polite");
  }
  if (field("state").textContent !== text) field("state").textContent = text;
}

function redraw() {
  clearTimeout(drawing);
  drawing = 0;
  if (!now?.n) return;
  say();
  const place = data.places[field("place").value];
  const signal = data.recorded[field("signal").value];
  const t = shownTime(place);
  const row = rowAt(now, t);
  const runs = shownRuns().filter((run) => run.n);
  const series = (of) => runs.map((run) => ({ ...of(run), kind: styleOf(run), label: wordOf(run) }));
  const columns = Math.max(200, charts.time.figure.clientWidth);
  const speeds = runs.flatMap((run) => run.plan.speeds).map((each) => each / TURN);
  const steady = isSteady(now);
  if (place) {
    charts.amplitude.draw({
      series: series((run) => thinned(abscissa(run), amplitude(run, place), columns)),
      xLabel: steady ? "Time [s]" : "Speed [Hz]",
      yLabel: `${place.amplitude ? "Amplitude" : "Distance from the centre"}, ${place.title} [µm]`,
      cursor: steady ? t : hertz(now, row),
      from: 0,
      xRange: steady ? null : [Math.min(...speeds), Math.max(...speeds)],
    });
    const orbits = series((run) => {
      const span = turnsUpTo(run, rowAt(run, t), 2);
      const of = (name) => scaled(column(run, name).slice(...span), 1e6);
      return { x: of(place.x), y: of(place.y) };
    });
    if (place.clearance) {
      const radius = 1e6 * (now.given[place.clearance] ?? byName.get(place.clearance).start);
      const angles = Array.from({ length: 121 }, (_, i) => (i * TURN) / 120);
      const ring = (of) => angles.map((angle) => radius * of(angle));
      orbits.push({ x: ring(Math.cos), y: ring(Math.sin), kind: "ring" });
    }
    charts.orbit.draw({ series: orbits, xLabel: "x [µm]", yLabel: `y, ${place.title} [µm]`, equal: true });
  }
  const yLabel = `${signal.label}${signal.unit ? ` [${signal.unit}]` : ""}`;
  const over = (run, first, last) => ({
    x: run.t.subarray(first, last),
    y: scaled(column(run, signal.name).subarray(first, last), signal.factor),
  });
  charts.time.draw({
    series: series((run) => {
      const { x, y } = over(run, 0, run.n);
      return thinned(x, y, columns);
    }),
    xLabel: "Time [s]",
    yLabel,
    cursor: t,
    xRange: [0, Math.max(...runs.map((run) => run.plan.duration))],
  });
  const [first, last] = turnsUpTo(now, row, 6);
  const span = [now.t[first], now.t[last - 1]];
  if (span[1] > span[0]) {
    charts.near.draw({
      series: series((run) => {
        const { x, y } = over(run, rowAt(run, span[0]), rowAt(run, span[1]) + 1);
        return thinned(x, y, 2000);
      }),
      xLabel: "Time [s]",
      yLabel,
      cursor: t,
      xRange: span,
    });
  }
  const hz = hertz(now, row);
  const value = column(now, signal.name)[row] * signal.factor;
  const parts = [`t = ${digits(now.t[row], 6)} s, ${digits(hz, 4)} Hz (${Math.round(60 * hz)} rpm)`];
  if (place) parts.push(`amplitude of ${place.title} ${digits(amplitude(now, place)[row], 4)} µm`);
  parts.push(`${signal.label} ${digits(value)} ${signal.unit}`);
  field("reading").textContent = parts.join("; ");
  if (picked === null) field("cursor").value = Math.round((1000 * now.t[row]) / now.plan.duration);
  field("cursor").setAttribute("aria-valuetext", `${digits(now.t[row], 4)} s`);
}

// --- CSV --------------------------------------------------------------------------------------

function csv(run) {
  const lines = [["time", ...data.recorded.map((each) => each.name)].join(",")];
  for (let i = 0; i < run.n; i++) {
    lines.push([run.t[i], ...run.columns.map((each) => each[i])].join(","));
  }
  return `${lines.join("\n")}\n`;
}

function save() {
  const address = URL.createObjectURL(new Blob([csv(now)], { type: "text/csv" }));
  const name = data.name.replace(/[^\p{L}\p{N} ._-]/gu, "_").trim() || "run";
  make("a", { href: address, download: `${name}.csv` }).click();
  setTimeout(() => URL.revokeObjectURL(address), 60000);
}

async function copyLink() {
  history.replaceState(null, "", `#${hash()}`);
  let text = "The address of this page now holds the settings.";
  try {
    await navigator.clipboard.writeText(location.href);
    text = "Link copied.";
  } catch {
    // the address says it
  }
  field("state").textContent = text;
}

// --- the beginning ----------------------------------------------------------------------------

async function open() {
  buildControls();
  data.places.forEach((place, i) => field("place").append(new Option(place.title, i)));
  data.recorded.forEach((each, i) => field("signal").append(new Option(each.label, i)));
  const first = data.places[0];
  field("signal").value = Math.max(0, columnOf.get(first?.x) ?? 0);
  const notes = readHash();
  field("settings").addEventListener("submit", (event) => event.preventDefault());
  field("settings").addEventListener("change", later);
  field("run").addEventListener("click", () => begin());
  field("stop").addEventListener("click", () => {
    halt();
    end(now, "stopped");
  });
  field("reset").addEventListener("click", () => {
    for (const name of Object.keys(values)) delete values[name];
    controls.forEach(show);
    later();
  });
  for (const id of ["place", "signal", "compare"]) field(id).addEventListener("change", redraw);
  field("cursor").addEventListener("input", () => {
    if (!now?.n) return;
    picked = (field("cursor").value / 1000) * now.plan.duration;
    redraw();
  });
  field("link").addEventListener("click", copyLink);
  field("csv").addEventListener("click", save);
  window.addEventListener("hashchange", () => begin(readHash()));
  window.addEventListener("resize", redraw);
  const [wasm, table] = await Promise.all([inflated("wasm"), inflated("table")]);
  stored = { wasm, table };
  begin(notes);
  document.documentElement.dataset.ready = "yes";
}

open();
