// The page: runs in a worker, CSV, and the beginning.

const DRAW_AFTER = 120; // [ms]
const WAIT = 250; // between a change and its run [ms]

async function inflated(id) {
  const letters = atob(field(id).textContent);
  const bytes = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

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
  if (now?.isShown) before = now;
  now = null;
  let plan;
  try {
    plan = planOf(data, values);
  } catch (error) {
    notice(error.message);
    field("state").textContent = "Not run.";
    clear();
    return;
  }
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

// Show that the settings have no run, not even the one before.
function clear() {
  Object.values(charts).forEach((chart) => chart.clear());
  field("reading").textContent = "";
  field("progress").value = 0;
  field("csv").disabled = true;
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
  if (run.n) field("csv").disabled = false;
  else clear();
  if (failure) notice(`The run ended early: ${failure}`);
  redraw();
  finished += 1;
  document.documentElement.dataset.runs = finished;
}

function later() {
  clearTimeout(waiting);
  if (field("auto").checked) waiting = setTimeout(begin, WAIT);
}

// --- CSV --------------------------------------------------------------------------------------

// Under the heads that the CSV file of a run has.
function csv(run) {
  const heads = data.recorded.map(({ name, si }) => (si === "1" ? name : `${name} [${si}]`));
  const lines = [["time [s]", ...heads].join(",")];
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
  const ofPlaces = [field("place").parentElement, charts.distance.figure, charts.orbit.figure];
  for (const each of ofPlaces) each.hidden = !first;
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
    picked = (field("cursor").value / 1000) * durationOf(now);
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
