// The pictures of the run, and of the one before.

const charts = {
  distance: new Chart("distance", (speed) => pickWhere(abscissa(now), speed)),
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
// A run that ended early is shown as far as it came: its axes have no room for the rest.
const isCut = (run) => Boolean(run.failure) && run.n > 1;
const durationOf = (run) => (isCut(run) ? run.t[run.n - 1] : run.plan.duration);
const speedsOf = (run) => {
  if (!isCut(run)) return run.plan.speeds.map((each) => each * SPEED.factor);
  return [speedAt(run, 0), speedAt(run, run.n - 1)];
};
const scaled = (list, factor) => list.map((value) => value * factor);
const { speed: SPEED, displacement: SMALL } = data.units;
const nameOf = (place) => `distance of ${place.title} from ${place.farthest ? "its start" : "the centre"}`;

// Of both runs the time, or of both the speed: they share the picture's axis.
function abscissa(run) {
  return isSteady(now) ? run.t.subarray(0, run.n) : scaled(column(run, "w"), SPEED.factor);
}

function distance(run, place) {
  if (place.farthest) return scaled(column(run, place.farthest), SMALL.factor);
  const [x, y] = [column(run, place.x), column(run, place.y)];
  return x.map((value, i) => SMALL.factor * Math.hypot(value, y[i]));
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
  field("cursor").value = Math.round((1000 * t) / durationOf(now));
  redraw();
}

// Rows of so many turns up to a row.
function turnsUpTo(run, row, turns) {
  const phi = column(run, "phi");
  let first = row;
  while (first > 0 && Math.abs(phi[row] - phi[first]) < turns * TURN) first -= 1;
  return [first, row + 1];
}

// Time until which a run is in its start-up.
function startUp(run) {
  const { turns, share } = data.startUp;
  const settled = (turns * TURN) / Math.max(...run.plan.speeds.map(Math.abs));
  return Math.min(settled, share * durationOf(run));
}

// Row of the largest distance after the start-up.
function largestRow(run, place) {
  const list = distance(run, place);
  const over = startUp(run);
  let best = Math.max(0, run.t.subarray(0, run.n).findIndex((t) => t > over));
  for (let i = best; i < list.length; i++) if (list[i] > list[best]) best = i;
  return best;
}

function largestOf(run, place) {
  const row = largestRow(run, place);
  const largest = `${digits(distance(run, place)[row], 4)} ${SMALL.unit}`;
  return `${largest} at ${digits(speedAt(run, row), 4)} ${SPEED.unit}`;
}

// Zero where round-off alone is left of the speed.
function speedAt(run, row) {
  const w = column(run, "w")[row];
  return Math.abs(w) < 1e-9 * Math.max(...run.plan.speeds.map(Math.abs)) ? 0 : w * SPEED.factor;
}

// The time picked; without one the last, and that of the largest distance in a run that has ended.
function shownTime(place) {
  if (picked !== null) return picked;
  return now.t[place && now.seconds !== undefined ? largestRow(now, place) : now.n - 1];
}

function say() {
  const share = now.n / now.plan.rows;
  field("progress").value = share;
  const place = data.places[field("place").value];
  let text = `Running: ${digits(now.n ? now.t[now.n - 1] : 0, 3)} of ${digits(now.plan.duration, 4)} s.`;
  if (now.seconds !== undefined) {
    const how = now.failure ? "Ended early" : "Done";
    text = `${how} after ${digits(now.seconds, 2)} s.`;
    if (!place) {
      text += " No part's motion is observed: give the machine a disc, a body or a sensor.";
    } else if (now.n) {
      text += ` Largest ${nameOf(place)} after the start-up: ${largestOf(now, place)}`;
      if (shownRuns().length > 1) text += `; the run before: ${largestOf(before, place)}`;
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
  if (!now) return;
  say();
  if (!now.n) return;
  const place = data.places[field("place").value];
  const signal = data.recorded[field("signal").value];
  const t = shownTime(place);
  const row = rowAt(now, t);
  const runs = shownRuns().filter((run) => run.n);
  const series = (of) => runs.map((run) => ({ ...of(run), kind: styleOf(run), label: wordOf(run) }));
  const columns = Math.max(200, charts.time.figure.clientWidth);
  const speeds = runs.flatMap(speedsOf);
  const steady = isSteady(now);
  if (place) {
    const size = `Distance from ${place.farthest ? "its start, largest in a turn" : "the centre"}`;
    charts.distance.caption.textContent = `${size}, over ${steady ? "time" : "speed"}`;
    const drawn = (run, ...rows) =>
      thinned(abscissa(run).slice(...rows), distance(run, place).slice(...rows), columns);
    const endOf = (run) => rowAt(run, startUp(run));
    const early = runs.map((run) => ({ ...drawn(run, 0, endOf(run) + 1), kind: "early" }));
    early.at(-1).label = `start-up, the first ${digits(startUp(now), 3)} s`;
    charts.distance.draw({
      series: [...series((run) => drawn(run, endOf(run))), ...early],
      xLabel: steady ? "Time [s]" : `Speed [${SPEED.unit}]`,
      yLabel: `Distance, ${place.title} [${SMALL.unit}]`,
      cursor: steady ? t : speedAt(now, row),
      from: 0,
      xRange: steady ? null : [Math.min(...speeds), Math.max(...speeds)],
    });
    const orbits = series((run) => {
      const span = turnsUpTo(run, rowAt(run, t), 2);
      const of = (name) => scaled(column(run, name).slice(...span), SMALL.factor);
      return { x: of(place.x), y: of(place.y) };
    });
    if (place.clearance) {
      const radius = SMALL.factor * (now.given[place.clearance] ?? byName.get(place.clearance).start);
      const angles = Array.from({ length: 121 }, (_, i) => (i * TURN) / 120);
      const ring = (of) => angles.map((angle) => radius * of(angle));
      orbits.push({ x: ring(Math.cos), y: ring(Math.sin), kind: "ring", label: "clearance of this run" });
    }
    const [xLabel, yLabel] = ["x", `y, ${place.title}`].map((text) => `${text} [${SMALL.unit}]`);
    charts.orbit.draw({ series: orbits, xLabel, yLabel, equal: true });
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
    xRange: [0, Math.max(...runs.map(durationOf))],
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
  const speed = `${digits(speedAt(now, row), 4)} ${SPEED.unit}`;
  const value = column(now, signal.name)[row] * signal.factor;
  const parts = [`t = ${digits(now.t[row], 6)} s, ${speed}`];
  if (place) {
    const size = `${digits(distance(now, place)[row], 4)} ${SMALL.unit}`;
    parts.push(`${nameOf(place)}${place.farthest ? ", largest in the last turn:" : ""} ${size}`);
  }
  parts.push(`${signal.label} ${digits(value)} ${signal.unit}`);
  field("reading").textContent = parts.join("; ");
  if (picked === null) field("cursor").value = Math.round((1000 * now.t[row]) / durationOf(now));
  field("cursor").setAttribute("aria-valuetext", `${digits(now.t[row], 4)} s`);
}
