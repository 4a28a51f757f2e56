// The page of a periodic response: curves over the parameter, and the orbit of one point of them.

const field = (id) => document.getElementById(id);
const PAINTS = 5;

class ResponseCurves {
  constructor(response) {
    this.response = response;
    this.row = 0;
    const { parameter, unit } = response;
    this.chart = new Chart("curve", {
      x: " ", y: " ", tools: "pan,box_zoom,wheel_zoom,reset", height: 420,
    });
    this.chart.plot.below[0].axis_label = verbatim(unit === "1" ? parameter : `${parameter} [${unit}]`);
    this.orbit = new Chart("orbit", {
      x: `Horizontal [${response.small}]`, y: `Vertical [${response.small}]`, square: true, tools: "pan,wheel_zoom,box_zoom,reset",
      height: 420,
    });
    this.branches = Math.max(-1, ...response.branch) + 1;
    this.lines = Array.from({ length: this.branches }, (_, b) => [1, 0].map((stable) => {
      const source = this.chart.source(["x", "y"]);
      const options = { line_width: stable ? 2.2 : 1.4 };
      this.chart.line(source, `c${b % PAINTS}`, stable ? 0 : 1, options);
      return source;
    }));
    this.marks = this.chart.source(["x", "y", "kind"]);
    const column = (name) => ({ field: name });
    const squares = this.chart.plot.scatter(column("x"), column("y"), {
      source: this.marks, size: 9, marker: "diamond", line_width: 1.5,
    });
    this.chart.keep(squares, { line_color: "mark", fill_color: "ground" });
    this.chart.plot.add_tools(new Bokeh.HoverTool({
      renderers: [squares], tooltips: [["", "@kind"], [parameter, "@x{custom}"]],
      formatters: { "@x": significant() },
    }));
    this.one = this.chart.source(["x", "y"]);
    this.chart.dots(this.one, "mark", 10);
    this.path = this.orbit.source(["x", "y"]);
    this.orbit.line(this.path, "c0");
    this.turns = this.orbit.source(["x", "y"]);
    this.orbit.dots(this.turns, "mark", 9);
    this.orbit.name([["path", "c0"], ...(response.frequency ? [] : [["keyphasor mark", "mark"]])]);
    this.chart.plot.on_event("mousemove", (event) => this.follow(event.x, event.y));
    this.chart.onTap((x, y) => this.follow(x, y));
  }

  get place() {
    return this.response.places.find(({ name }) => name === field("place").value);
  }

  get values() {
    return this.place.curves[field("quantity").value];
  }

  // Every branch in two lines, broken where the other one goes on; both have the point between.
  draw() {
    const { value, branch, stable } = this.response.line;
    const y = this.place.lines[field("quantity").value];
    this.lines.forEach((pair, b) => pair.forEach((source, k) => {
      const wanted = k === 0 ? 1 : 0;
      const line = { x: [], y: [] };
      const put = (i, shows) => {
        line.x.push(value[i]);
        line.y.push(shows ? y[i] : NaN);
      };
      for (let i = 0; i < value.length; i++) {
        if (branch[i] !== b) continue;
        const follows = i > 0 && branch[i - 1] === b && stable[i - 1] === wanted;
        put(i, stable[i] === wanted || follows);
        if (follows && stable[i] !== wanted) put(i, false);
      }
      source.data = line;
    }));
    const { kind } = this.response;
    const marked = [...kind.keys()].filter((i) => kind[i] !== "");
    this.marks.data = {
      x: marked.map((i) => this.response.value[i]), y: marked.map((i) => this.values[i]),
      kind: marked.map((i) => kind[i]),
    };
    const unit = this.response.quantities[field("quantity").value];
    this.chart.plot.left[0].axis_label = verbatim(`${this.place.name}.${field("quantity").value} [${unit}]`);
    this.chart.name([
      ...this.lines.map((_, b) => [`branch ${b + 1}`, `c${b % PAINTS}`]),
      ["stable", "soft"], ["unstable", "soft", 1],
    ]);
    this.pick(this.row);
  }

  // The point that is nearest in the picture, not in the units of its axes.
  follow(atX, atY) {
    const { x_range: across, y_range: up } = this.chart.plot;
    const { value } = this.response;
    const y = this.values;
    let [best, least] = [0, Infinity];
    for (let i = 0; i < value.length; i++) {
      const dx = (value[i] - atX) / (across.end - across.start);
      const dy = (y[i] - atY) / (up.end - up.start);
      const distance = dx * dx + dy * dy;
      if (distance < least) [best, least] = [i, distance];
    }
    if (best !== this.row) this.pick(best);
  }

  pick(row) {
    const { response } = this;
    this.row = Math.min(Math.max(row, 0), response.value.length - 1);
    const i = this.row;
    const [value, y] = [response.value[i], this.values[i]];
    this.one.data = { x: [value], y: [y] };
    const { samples } = response;
    const { curves, size } = this.place;
    const cut = (axis) => [...this.place[axis].subarray(i * samples, (i + 1) * samples)]
      .map((share) => curves[axis][i] + size[i] * share);
    const [px, py] = [cut("x"), cut("y")];
    this.path.data = { x: [...px, px[0]], y: [...py, py[0]] };
    const every = samples / response.turns[i];
    const marks = Array.from({ length: response.turns[i] }, (_, k) => Math.round(k * every));
    this.turns.data = { x: marks.map((k) => px[k]), y: marks.map((k) => py[k]) };
    if (document.activeElement !== field("point")) field("point").value = i;
    const quantity = field("quantity").value;
    const unit = (text) => (text === "1" ? "" : ` ${text}`);
    const text = [
      `${response.parameter} ${shown(value)}${unit(response.unit)}`,
      `${this.place.name}.${quantity} ${shown(y)} ${response.quantities[quantity]}`,
      response.kind[i] || (response.stable[i] ? "stable" : "unstable"),
      ...(response.frequency ? [`whirl ${shown(response.whirl[i])} ${response.frequency}`] : []),
      `${response.kind[i] ? "crossing" : "largest"} multiplier ${shown(response.multiplier[i])}`,
      `${response.harmonics[i]} harmonics`,
      `branch ${response.branch[i] + 1}`,
    ].join(", ");
    field("reading").textContent = text;
    this.orbit.describe(`Point ${i}: ${text}.`);
    this.chart.describe(`${response.value.length} points. Point ${i}: ${text}.`);
  }
}

function choices(id, names) {
  field(id).replaceChildren(
    ...names.map((name) => {
      const option = document.createElement("option");
      option.value = option.textContent = name;
      return option;
    }),
  );
}

let curves = null;

async function start() {
  const response = await unpackAll(readData("data"));
  curves = new ResponseCurves(response);
  choices("place", response.places.map(({ name }) => name));
  choices("quantity", Object.keys(response.quantities));
  // the place that moves most
  const largest = ({ curves: { r_amp } }) => r_amp.reduce((a, b) => Math.max(a, b), 0);
  const first = response.places.reduce((a, b) => (largest(b) >= largest(a) ? b : a));
  field("place").value = first.name;
  for (const id of ["place", "quantity"]) field(id).addEventListener("change", () => curves.draw());
  field("point").addEventListener("input", () => curves.pick(Number(field("point").value)));
  field("before").addEventListener("click", () => curves.pick(curves.row - 1));
  field("after").addEventListener("click", () => curves.pick(curves.row + 1));
  curves.draw();
  await curves.chart.show();
  performance.mark("first picture");
  await curves.orbit.show();
  document.documentElement.dataset.ready = "yes";
}

start().catch((error) => {
  document.querySelector("main").insertAdjacentHTML(
    "afterbegin", '<p class="notice" role="alert">The pictures could not be drawn by this browser.</p>',
  );
  console.error(error);
});
