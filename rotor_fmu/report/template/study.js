// The page of a study: a map whose points are runs, and everything about the one that is picked.

const field = (id) => document.getElementById(id);

// Room about values that are all the same, as large as they are.
const around = (values) => Math.abs(values.find(Number.isFinite) ?? 0) || 1;

class StudyMap {
  constructor(study) {
    this.study = study;
    this.columns = new Map(study.columns.map((column) => [column.name, column]));
    this.chart = new Chart("map", {
      x: " ", y: " ", tools: "pan,box_zoom,wheel_zoom,reset", height: 420,
    });
    this.chart.plot.toolbar.active_scroll = null;
    const column = (name) => ({ field: name });
    this.runs = this.chart.source(["x", "y", "c"]);
    this.failed = this.chart.source(["x", "y"]);
    this.one = this.chart.source(["x", "y"]);
    this.mapper = new Bokeh.LinearColorMapper({
      palette: Bokeh.Palettes.Cividis256, low: 0, high: 1,
    });
    const dots = this.chart.plot.scatter(column("x"), column("y"), {
      source: this.runs, size: 8, line_width: 0.7,
      fill_color: { field: "c", transform: this.mapper },
    });
    this.chart.keep(dots, { line_color: "soft" });
    const crosses = this.chart.plot.scatter(column("x"), column("y"), {
      source: this.failed, size: 8, marker: "x", line_width: 1.5, fill_color: null,
    });
    this.chart.keep(crosses, { line_color: "c1" });
    this.doubtful = this.chart.source(["x", "y"]);
    const squares = this.chart.plot.scatter(column("x"), column("y"), {
      source: this.doubtful, size: 12, marker: "square", line_width: 1.5, fill_color: null,
    });
    this.chart.keep(squares, { line_color: "c1" });
    const ring = this.chart.plot.scatter(column("x"), column("y"), {
      source: this.one, size: 15, line_width: 3, fill_color: null,
    });
    this.chart.keep(ring, { line_color: "c1" });
    this.bar = new Bokeh.ColorBar({ color_mapper: this.mapper, width: 12 });
    this.chart.plot.add_layout(this.bar, "right");
    this.chart.painted.push([
      this.bar,
      {
        background_fill_color: "ground", major_label_text_color: "ink", title_text_color: "ink",
      },
    ]);
    this.chart.onTap((x, y) => this.pick(this.nearest(x, y)));
    if (study.curves.length) {
      this.curve = new Chart("curve", {
        x: " ", y: " ", xRange: new Bokeh.Range1d(), yRange: new Bokeh.Range1d(),
      });
      this.line = this.curve.source(["x", "y"]);
      this.curve.line(this.line, "c0");
      this.curve.dots(this.line, "c0", 5);
    }
  }

  label(name) {
    const { unit } = this.columns.get(name);
    return unit ? `${name} [${unit}]` : name;
  }

  draw() {
    const [x, y, c] = ["across", "up", "shade"].map((id) => this.study.values[field(id).value]);
    const { status } = this.study;
    const good = [];
    const bad = [];
    for (let i = 0; i < x.length; i++) {
      const isKnown = [x, y, c].every((values) => Number.isFinite(values[i]));
      (isKnown && !status[i].startsWith("failed") ? good : bad).push(i);
    }
    const of = (values, rows) => rows.map((i) => values[i]);
    this.runs.data = { x: of(x, good), y: of(y, good), c: of(c, good) };
    const doubtful = good.filter((i) => status[i] !== "ok");
    this.doubtful.data = { x: of(x, doubtful), y: of(y, doubtful) };
    this.chart.plot.x_range.default_span = around(x);
    this.chart.plot.y_range.default_span = around(of(y, good));
    // what has no value there is shown at the left or the bottom edge
    const placed = (values) => {
      const lowest = good.reduce((least, i) => Math.min(least, values[i]), Infinity);
      const edge = Number.isFinite(lowest) ? lowest : 0;
      return [...values].map((value) => (Number.isFinite(value) ? value : edge));
    };
    this.places = { x: placed(x), y: placed(y) };
    this.failed.data = { x: of(this.places.x, bad), y: of(this.places.y, bad) };
    const shades = of(c, good);
    this.mapper.low = shades.reduce((a, b) => Math.min(a, b), Infinity);
    this.mapper.high = shades.reduce((a, b) => Math.max(a, b), -Infinity);
    if (!shades.length) [this.mapper.low, this.mapper.high] = [0, 1];
    if (this.mapper.low === this.mapper.high) this.mapper.high += around(shades);
    this.bar.title = verbatim(this.label(field("shade").value));
    this.chart.plot.below[0].axis_label = verbatim(this.label(field("across").value));
    this.chart.plot.left[0].axis_label = verbatim(this.label(field("up").value));
    this.chart.name([
      [`${good.length} runs`, "c0"],
      ...(doubtful.length ? [[`${doubtful.length} of them doubtful (squares)`, "c1"]] : []),
      ...(bad.length ? [[`${bad.length} failed, or without the value (crosses)`, "c1"]] : []),
    ]);
    this.point();
  }

  // Nearest in the picture, not in the units of its axes.
  nearest(atX, atY) {
    const { x_range: across, y_range: up } = this.chart.plot;
    const { x, y } = this.places;
    let best = 0;
    let least = Infinity;
    for (let i = 0; i < x.length; i++) {
      const dx = (x[i] - atX) / (across.end - across.start);
      const dy = (y[i] - atY) / (up.end - up.start);
      const distance = dx * dx + dy * dy;
      if (distance < least) [best, least] = [i, distance];
    }
    return best;
  }

  pick(row) {
    this.row = Math.min(Math.max(row, 0), this.study.ids.length - 1);
    this.point();
  }

  point() {
    const { study, row } = this;
    if (row === undefined) return;
    this.one.data = { x: [this.places.x[row]], y: [this.places.y[row]] };
    if (document.activeElement !== field("run")) field("run").value = study.runs[row];
    const entries = [["id", study.ids[row]], ["status", study.status[row]]];
    for (const { name } of study.columns) entries.push([this.label(name), shown(study.values[name][row])]);
    const page = study.pages[study.ids[row]];
    const again = `rotor-fmu study ... --select ${study.ids[row]}`;
    if (page) entries.push(["its signals", "its page"]);
    else if (study.again) entries.push(["with its signals", again]);
    const lines = entries.map(([name, value]) => {
      const line = document.createElement("tr");
      for (const text of [name, value]) line.insertCell().textContent = text;
      return line;
    });
    if (page) {
      const link = document.createElement("a");
      link.href = page;
      link.textContent = "its page";
      lines.at(-1).cells[1].replaceChildren(link);
    }
    field("picked").tBodies[0].replaceChildren(...lines);
    const chosen = ["across", "up", "shade"].map((id) => field(id).value);
    const value = (name) => {
      const { unit } = this.columns.get(name);
      const number = shown(study.values[name][row]);
      return `${name} ${number}${number !== "-" && unit && unit !== "-" ? ` ${unit}` : ""}`;
    };
    const values = [...new Set(chosen)].map(value).join(", ");
    const text = `Run ${study.runs[row]}, ${study.ids[row]}: ${values}; ${study.status[row]}`;
    field("reading").textContent = text;
    this.chart.describe(`${study.ids.length} runs. ${text}`);
    this.drawCurve();
  }

  span(range, values) {
    const known = values.filter(Number.isFinite);
    const low = known.reduce((a, b) => Math.min(a, b), Infinity);
    const high = known.reduce((a, b) => Math.max(a, b), -Infinity);
    if (!known.length) return;
    const margin = 0.04 * (high - low) || around(known) / 2;
    const [start, end] = [low - margin, high + margin];
    range.setv({ start, end, reset_start: start, reset_end: end });
  }

  drawCurve() {
    if (!this.curve) return;
    const kept = this.study.curves.find((curve) => curve.name === field("kept").value);
    const width = kept.coordinate.length;
    const y = kept.values.slice(this.row * width, (this.row + 1) * width);
    this.line.data = { x: kept.coordinate, y };
    this.span(this.curve.plot.x_range, kept.coordinate);
    // all runs on one scale, so that they compare
    this.span(this.curve.plot.y_range, kept.values);
    const [below, left] = [this.curve.plot.below[0], this.curve.plot.left[0]];
    below.axis_label = verbatim(`${kept.dimension} [${kept.coordinate_unit}]`);
    left.axis_label = verbatim(`${kept.name} [${kept.unit}]`);
    this.curve.describe(`${kept.text} of run ${this.study.runs[this.row]}.`);
  }
}

function choices(id, names, chosen) {
  field(id).replaceChildren(
    ...names.map((name) => {
      const option = document.createElement("option");
      option.value = option.textContent = name;
      return option;
    }),
  );
  if (chosen) field(id).value = chosen;
}

let map = null;

async function start() {
  const study = await unpackAll(readData("data"));
  map = new StudyMap(study);
  const names = study.columns.map((column) => column.name);
  const kept = names.filter((name) => !study.axes.includes(name));
  const [first, second] = study.axes;
  choices("across", names, first);
  choices("up", names, second ?? kept[0]);
  choices("shade", names, second ? (kept[0] ?? second) : (kept[1] ?? kept[0]));
  choices("kept", study.curves.map((curve) => curve.name));
  for (const id of ["across", "up", "shade"]) field(id).addEventListener("change", () => map.draw());
  field("kept").addEventListener("change", () => map.drawCurve());
  field("run").addEventListener("input", () => {
    const row = study.runs.indexOf(Number(field("run").value));
    if (row >= 0) map.pick(row);
  });
  field("before").addEventListener("click", () => map.pick(map.row - 1));
  field("after").addEventListener("click", () => map.pick(map.row + 1));
  map.draw();
  map.pick(0);
  await map.chart.show();
  performance.mark("first picture");
  await map.curve?.show();
  document.documentElement.dataset.ready = "yes";
}

start().catch((error) => {
  document.querySelector("main").insertAdjacentHTML(
    "afterbegin", '<p class="notice" role="alert">The pictures could not be drawn by this browser.</p>',
  );
  console.error(error);
});
