// The page of one or two runs: what is picked, and the words for it.

const field = (id) => document.getElementById(id);

function whirling(sense) {
  if (!Number.isFinite(sense)) return "";
  if (Math.abs(sense) <= 0.05) return "; whirls on a line";
  return sense < 0 ? "; whirls backward" : "; whirls forward";
}

// In both units, the one that is shown first.
function speedOf(hz) {
  const both = [`${shown(hz)} Hz`, `${Math.round(60 * hz)} rpm`];
  if (over.turns !== 1) both.reverse();
  return `${both[0]} (${both[1]})`;
}

function sentence(found, run, several) {
  return (
    `${several ? `${run.name}, ` : ""}${found.label} at ${speedOf(found.hz)}, t = ${shown(found.t)} s: ` +
    `1x of x ${shown(found.x)} ${over.chosenUnit.text} at ${Math.round(found.phaseX)}°, ` +
    `of y ${shown(found.y)} at ${Math.round(found.phaseY)}°; ` +
    `largest line ${shown(run.orders[found.peak])}x${whirling(found.sense)}`
  );
}

let over = null;
let time = null;

function pick(station) {
  field("station").value = station;
  const found = over.pick(station);
  const several = over.runs.length > 1;
  const words = found.map((each, r) => (each ? sentence(each, over.runs[r], several) : ""));
  const text = words.filter(Boolean).join(". ");
  field("reading").textContent = text;
  field("station").setAttribute("aria-valuetext", speedOf(found[0].hz));
  for (const chart of [over.bode, over.phase, over.orbit, over.base, over.spectrum, over.polar]) {
    chart.describe(text);
  }
  over.cascade.describe("Shades show the amplitude over order and speed. " + text);
  over.poincare.describe("A point a turn; those near the speed picked stand out.");
  over.whirl.describe("1 is a forward circle, -1 a backward one. " + text);
  for (const chart of [over.force, over.angle, over.energy]) {
    chart.describe("Over the speed; the tables give its largest values.");
  }
}

function options(id, entries, chosen) {
  field(id).replaceChildren(
    ...entries.map(([value, text]) => {
      const option = document.createElement("option");
      option.value = value;
      option.textContent = text;
      return option;
    }),
  );
  if (chosen !== undefined) field(id).value = chosen;
  field(id).closest("label").hidden ||= entries.length === 0;
}

async function showOverSpeed(runs) {
  over = new OverSpeed(runs);
  options("place", runs[0].places.map((p) => [p.name, p.label]), runs[0].chosen);
  options("second", [["", "none"], ...runs[0].places.map((p) => [p.name, p.label])], "");
  options("touch", runs[0].touches.map((t) => [t.name, t.label]));
  options("shown", runs.map((run, r) => [r, run.name]));
  field("station").max = runs[0].stations.hz.length - 1;
  const refill = () => {
    over.fill(field("place").value, field("touch").value, field("second").value);
    over.fillCascade(Number(field("shown").value));
    over.scaleSpeed(Number(field("turns").value));
    pick(Number(field("station").value));
  };
  over.chosenUnit = UNITS[Number(field("unit").value)];
  over.fillBode(field("place").value);
  await over.bode.show();
  performance.mark("first picture");
  over.build();
  field("station").value = nearest(runs[0].stations.t, over.places[0].largest);
  refill();
  for (const id of ["place", "second", "touch", "shown", "turns"]) field(id).addEventListener("change", refill);
  field("unit").addEventListener("change", () => {
    over.chosenUnit = UNITS[Number(field("unit").value)];
    refill();
  });
  field("station").addEventListener("input", () => pick(Number(field("station").value)));
  const bySpeed = (value) => pick(nearest(runs[0].stations[over.across], value));
  for (const chart of over.overSpeed) chart.onTap(bySpeed);
  over.cascade.onTap((order, down) => {
    const { stations, isOneWay } = runs[over.shownRun];
    const at = nearest(isOneWay ? stations.hz : stations.t, down);
    bySpeed(stations[over.across][at]);
  });
  await over.show();
}

async function showOverTime(runs) {
  time = new TimeChart(runs);
  options("signal", runs[0].signals.map((signal, i) => [i, `${signal.label} [${signal.unit}]`]));
  field("signal").addEventListener("change", async () => {
    await time.choose(Number(field("signal").value));
    time.point(time.at);
  });
  await time.choose(0);
  const [first, last] = time.whole;
  time.range.setv({ reset_start: first, reset_end: last, bounds: [first, last] });
  time.view(first, last);
  const acts = {
    in: () => time.zoom(0.5), out: () => time.zoom(2), earlier: () => time.move(-0.5),
    later: () => time.move(0.5), all: () => time.view(...time.whole),
    near: () => {
      const { hz, t } = over.runs[0].stations;
      const at = Number(field("station").value);
      const four = 4 / Math.abs(hz[at]);
      time.view(t[at] - four, t[at] + four);
      time.point(t[at]);
    },
  };
  for (const [id, act] of Object.entries(acts)) field(id).addEventListener("click", act);
  field("near").hidden = over === null;
  field("cursor").addEventListener("input", () => time.point(Number(field("cursor").value)));
  time.point(over ? over.runs[0].stations.t[Number(field("station").value)] : 0);
  await time.chart.show();
}

async function start() {
  const runs = (await Promise.all(readData("data").runs.map(unpackAll))).filter((run) => !run.why);
  if (runs.length) await showOverSpeed(runs);
  await showOverTime(readData("signals"));
  document.documentElement.dataset.ready = "yes";
}

start().catch((error) => {
  document.querySelector("main").insertAdjacentHTML(
    "afterbegin", '<p class="notice" role="alert">The pictures could not be drawn by this browser.</p>',
  );
  console.error(error);
});
