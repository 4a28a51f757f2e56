// The pictures of a run over speed and at the speed that is picked; one colour a run.

const HERTZ = "Speed [Hz]";
// What amplitudes may be shown in: text, unit of displacements, its size [µm], factor of 0-p.
const UNITS = [
  { text: "µm 0-p", of: "µm", size: 1, times: 1 }, { text: "µm peak-to-peak", of: "µm", size: 1, times: 2 },
  { text: "mil 0-p", of: "mil", size: 25.4, times: 1 }, { text: "mil peak-to-peak", of: "mil", size: 25.4, times: 2 },
];

class OverSpeed {
  constructor(runs) {
    this.runs = runs;
    this.chosenUnit = UNITS[0];
    this.parts = runs.map(() => ({}));
    // a run at one speed goes over time
    this.across = runs.every((run) => run.isConstant) ? "t" : "hz";
    const label = this.across === "t" ? "Time [s]" : HERTZ;
    const values = runs.flatMap((run) => [...run.track[this.across]]);
    const highest = values.reduce((a, b) => Math.max(a, b), -Infinity);
    const lowest = values.reduce((a, b) => Math.min(a, b), Infinity);
    // down to standstill where the run comes near it; speeds are negative where it turns backward
    const margin = 0.02 * (highest - lowest);
    const from = lowest >= 0 && lowest < 0.4 * highest ? 0 : lowest - margin;
    const to = highest <= 0 && highest > 0.4 * lowest ? 0 : highest + margin;
    this.shared = (id, y, options = {}) =>
      new Chart(id, { x: label, y, xRange: fixedRange(from, to), ...options });
    // the linear critical speeds of the machine of the first run
    const criticals = this.across === "hz" ? runs[0].criticals?.hz ?? [] : [];
    this.bode = new Bode(this.parts, { label, xRange: fixedRange(from, to), criticals });
    this.turns = 1; // what is shown of a hertz: 1, or 60 revolutions a minute
  }

  // What one µm of amplitude, and of displacement, is in the unit that is shown.
  get factor() {
    return this.chosenUnit.times / this.chosenUnit.size;
  }

  get small() {
    return 1 / this.chosenUnit.size;
  }

  get lone() {
    return this.runs.length === 1;
  }

  // What tooltips and axes say of speeds: hertz, or revolutions a minute.
  scaleSpeed(turns) {
    this.turns = turns;
    const unit = turns === 1 ? "Hz" : "rpm";
    const isSpeed = this.across === "hz";
    this.bode.hover.formatters = { "@x": significant(isSpeed ? turns : 1), "@y": significant() };
    this.bode.hover.tooltips = [
      ["line", "$name"], ["amplitude", `@y{custom} ${this.chosenUnit.text}`],
      isSpeed ? ["speed", `@x{custom} ${unit}`] : ["time", "@x{custom} s"],
    ];
    const formatter = () => turns === 1 ? new Bokeh.BasicTickFormatter()
      : new Bokeh.CustomJSTickFormatter({ code: `return String(+(${turns} * tick).toFixed(1))` });
    // ticks at round numbers of what is shown: 100 / 60 Hz is 100 rpm
    const mantissas = [1, 2, 5].map((each) => (each / turns) * (turns === 1 ? 1 : 100));
    const ticker = () => new Bokeh.AdaptiveTicker({ mantissas });
    const scale = () => ({ formatter: formatter(), ticker: ticker() });
    const name = (axis) => axis.setv({ axis_label: `Speed [${unit}]`, ...scale() });
    if (isSpeed) this.overSpeed.forEach((chart) => name(chart.plot.below[0]));
    const frequency = turns === 1 ? "Hz" : "cpm";
    this.spectrum.plot.below[0].setv({
      axis_label: `Whirl frequency [${frequency}], backward < 0`, ...scale(),
    });
    this.lineHover.formatters = { "@x": significant(turns), "@top": significant() };
    this.lineHover.tooltips = [["", `@x{custom} ${frequency}, @order{0.000}x: @top{custom}`]];
    if (this.runs[this.shownRun ?? 0].isOneWay) name(this.cascade.plot.left[0]);
  }

  // All but the first picture, which does not wait for them.
  build() {
    const { shared } = this;
    this.orbit = new Chart("orbit", {
      x: "Horizontal [µm]", y: "Vertical [µm]", square: true, tools: "pan,wheel_zoom,box_zoom,reset",
      height: 320,
    });
    this.base = new Chart("timebase", { x: "Turns", y: "Displacement [µm]", height: 320 });
    this.phase = shared("phase", "Phase, lag negative [deg]");
    this.spectrum = new Chart("spectrum", { x: " ", y: " " });
    this.cascade = new Cascade("cascade");
    this.polar = new Chart("polar", {
      x: " ", y: " ", square: true, tools: "pan,wheel_zoom,box_zoom,reset", height: 340,
    });
    this.whirl = shared("whirl", "-1 backward, 0 a line, 1 forward", {
      yRange: fixedRange(-1.1, 1.1),
    });
    this.poincare = new Chart("poincare", {
      x: "Horizontal [µm]", y: "Vertical [µm]", square: true, tools: "pan,wheel_zoom,box_zoom,reset",
    });
    this.force = shared("force", `Largest of the turn [${this.runs[0].force}]`);
    this.angle = shared("angle", "Where it touches [deg]", {
      yRange: fixedRange(0, 360), tools: "pan,wheel_zoom,box_zoom,reset",
    });
    this.energy = shared("energy", "Power [W]");
    const touches = this.runs.some((run) => run.touches.length);
    for (const chart of [this.force, this.angle]) chart.figure.hidden = !touches;
    this.energy.figure.hidden = !this.runs.some((run) => run.power.sinks.length);
    this.overSpeed = [this.bode, this.phase, this.whirl, this.force, this.angle, this.energy];
    this.spans = this.overSpeed.map((chart) => chart.span("height"));
    link(this.overSpeed);
    this.runs.forEach((run, r) => this.lines(run, r));
    this.lineHover = new Bokeh.HoverTool({ mode: "vline" });
    this.spectrum.plot.add_tools(this.lineHover);
  }

  // Glyphs of one run, and the sources that feed them.
  lines(run, r) {
    const source = (chart, columns = ["x", "y"]) => chart.source(columns);
    const part = Object.assign(this.parts[r], {
      phaseX: source(this.phase), phaseY: source(this.phase),
      orbit: source(this.orbit), marks: source(this.orbit), ring: source(this.orbit),
      spectrum: source(this.spectrum, ["x", "top", "order"]), polar: source(this.polar),
      polarNow: source(this.polar), whirl: source(this.whirl), points: source(this.poincare),
      pointsNow: source(this.poincare), force: source(this.force), angle: source(this.angle),
      range: source(this.angle, ["x", "low", "high"]),
      sinks: (run.power?.sinks ?? []).map(() => source(this.energy)),
    });
    const paint = `c${r}`;
    part.base = [0, 1].map((axis) => {
      const feed = source(this.base);
      this.base.line(feed, this.lone ? `c${axis}` : paint, axis, { line_width: 1.5 });
      return feed;
    });
    part.baseMarks = source(this.base);
    this.base.dots(part.baseMarks, "mark", 7);
    part.otherOrbit = source(this.orbit);
    this.orbit.line(part.otherOrbit, `c${SECOND}`, SECOND, { line_width: 1.5 });
    this.phase.line(part.phaseX, this.lone ? "c0" : paint, 0);
    this.phase.line(part.phaseY, this.lone ? "c1" : paint, 1);
    this.orbit.line(part.ring, "soft", 1, { line_width: 1 });
    this.orbit.line(part.orbit, paint, 0, { line_width: 1.5 });
    this.orbit.dots(part.marks, "mark", 9);
    const bars = this.spectrum.plot.segment(
      { field: "x" }, { value: 0 }, { field: "x" }, { field: "top" },
      { source: part.spectrum, line_width: 2, line_dash: { value: DASHES[r] } },
    );
    this.spectrum.keep(bars, { line_color: paint });
    this.polar.line(part.polar, paint, r);
    this.polar.dots(part.polarNow, "mark", 9);
    this.whirl.dots(part.whirl, paint);
    this.poincare.dots(part.points, paint, 4);
    this.poincare.dots(part.pointsNow, "mark", 7);
    this.force.line(part.force, paint, r, { line_width: 1.5 });
    const ranges = this.angle.plot.segment(
      { field: "x" }, { field: "low" }, { field: "x" }, { field: "high" },
      { source: part.range, line_width: 1.5, line_alpha: 0.35 },
    );
    this.angle.keep(ranges, { line_color: paint });
    this.angle.dots(part.angle, paint);
    part.sinks.forEach((sink, i) => this.energy.line(sink, `c${i % 5}`, i + 3 * r));
  }

  async show() {
    const charts = [
      this.orbit, this.base, this.phase, this.spectrum, this.cascade, this.polar, this.whirl,
      this.poincare, this.force, this.angle, this.energy,
    ];
    for (const chart of charts) {
      if (!chart.figure.hidden) await chart.show();
    }
  }

  fillBode(placeName, secondName = "") {
    this.others = this.runs.map((run) => run.places.find((p) => p.name === secondName));
    this.places = this.runs.map(
      (run) => run.places.find((p) => p.name === placeName) ??
        run.places.find((p) => p.name === run.chosen),
    );
    this.bode.plot.left[0].axis_label = `1x amplitude [${this.chosenUnit.text}]`;
    const other = this.others[0];
    this.bode.name([
      ...this.each(LINES.map(([name], i) => [name, i, i])),
      ...(other ? [[`${other.label}, 1x of x`, `c${SECOND}`, SECOND]] : []),
      ...(this.bode.criticals.length ? [["linear critical speeds", "soft", 2]] : []),
    ]);
    this.runs.forEach((run, r) => {
      const [place, x] = [this.places[r], run.track[this.across]];
      if (place) this.bode.fill(this.parts[r], x, place, this.others[r], this.factor);
    });
  }

  // Curves of places and contacts by their names.
  fill(placeName, touchName, secondName) {
    this.fillBode(placeName, secondName);
    const unit = this.chosenUnit.text;
    const { of } = this.chosenUnit;
    for (const chart of [this.orbit, this.poincare]) {
      chart.plot.below[0].axis_label = `Horizontal [${of}]`;
      chart.plot.left[0].axis_label = `Vertical [${of}]`;
    }
    this.base.plot.left[0].axis_label = `Displacement from the mean [${of}]`;
    this.spectrum.plot.left[0].axis_label = `Amplitude [${unit}]`;
    this.polar.plot.below[0].axis_label = `1x of x, real part [${unit}]`;
    this.polar.plot.left[0].axis_label = `imaginary part [${unit}]`;
    this.runs.forEach((run, r) => {
      const part = this.parts[r];
      const place = this.places[r];
      if (!place) return;
      const { xRe, xIm, yRe, yIm } = place.curves;
      const x = run.track[this.across];
      part.phaseX.data = broken(x, xRe, xIm);
      part.phaseY.data = broken(x, yRe, yIm);
      const real = xRe.map((v) => this.factor * v);
      part.polar.data = { x: parted(x, real).y, y: xIm.map((v) => this.factor * v) };
      part.whirl.data = { x: run.whirl[this.across], y: place.sense };
      part.points.data = this.sized(place.points.re, place.points.im);
      part.ring.data = circle(place.clearance === null ? null : place.clearance * this.small);
      const touch = run.touches.find((t) => t.name === touchName);
      part.force.data = touch ? parted(touch[this.across], touch.peak) : { x: [], y: [] };
      part.angle.data = touch ? { x: touch[this.across], y: touch.angle } : { x: [], y: [] };
      part.range.data = ranges(touch?.[this.across], touch);
      part.sinks.forEach((sink, i) => {
        sink.data = parted(run.power[this.across], run.power.sinks[i].p);
      });
    });
    this.names();
  }

  // Displacements in the unit that is shown.
  sized(x, y) {
    return { x: x.map((v) => this.small * v), y: y.map((v) => this.small * v) };
  }

  // Names of lines that every run has, in the run's colour.
  each(entries) {
    return this.runs.flatMap((run, r) =>
      entries.map(([text, dash, paint]) => [
        this.lone ? text : `${run.name}: ${text}`, `c${this.lone ? paint ?? r : r}`, dash ?? r,
      ]),
    );
  }

  names() {
    const each = (entries) => this.each(entries);
    this.phase.name(each([["x", 0, 0], ["y", 1, 1]]));
    const ring = this.places.some((p) => p?.clearance != null) ? [["clearance", "soft", 1]] : [];
    const other = this.others[0] ? [[this.others[0].label, `c${SECOND}`, SECOND]] : [];
    this.orbit.name([...each([["path"]]), ...other, ["keyphasor mark", "mark"], ...ring]);
    this.base.name([...each([["x", 0, 0], ["y", 1, 1]]), ["keyphasor mark", "mark"]]);
    this.spectrum.name(each([["amplitude"]]));
    this.polar.name([...each([["all speeds"]]), ["the one picked", "mark"]]);
    const most = Math.max(...this.runs.map((run) => run.whirl.turns));
    this.whirl.name(each([[`over ${most} turns`]]));
    this.poincare.name([...each([["a point a turn"]]), ["near the speed picked", "mark"]]);
    this.force.name(each([["normal force"]]));
    this.angle.name([
      ...each([["mean and range of a turn"]]), ["270: at the bottom", "ground"],
      ["no mean where it goes all round", "ground"],
    ]);
    this.energy.name(
      this.runs.flatMap((run, r) =>
        (run.power?.sinks ?? []).map((sink, i) => [
          `${this.runs.length > 1 ? `${run.name}: ` : ""}${sink.label}, ${shown(sink.total)} J`,
          `c${i % 5}`, i + 3 * r,
        ]),
      ),
    );
  }

  fillCascade(r) {
    const largest = this.factor * this.cascade.fill(this.runs[r], this.places[r]);
    this.cascade.name([[`from 0 to ${shown(largest)} ${this.chosenUnit.text}`, "ground"]]);
    this.shownRun = r;
  }

  // Orbit, spectrum, marks at a station of the first run; others at their nearest speed.
  pick(station) {
    const hz = this.runs[0].stations.hz[station];
    return this.runs.map((run, r) => {
      const place = this.places[r];
      if (!place) return null;
      const at = r === 0 ? station : nearest(run.stations.hz, hz);
      const part = this.parts[r];
      const [now, t] = [run.stations.hz[at], run.stations.t[at]];
      const size = run.orbit.turns * run.orbit.points;
      const slice = (values) => values.subarray(at * size, (at + 1) * size);
      const { x, y } = this.sized(slice(place.orbits.re), slice(place.orbits.im));
      part.orbit.data = { x, y };
      const marks = (values) => values.filter((_, i) => i % run.orbit.points === 0);
      part.marks.data = { x: marks(x), y: marks(y) };
      const turns = x.map((_, i) => i / run.orbit.points);
      // about the mean, since on an oil film a shaft lies farther from zero than it vibrates
      const vibration = [x, y].map((values) => {
        const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
        return values.map((value) => value - mean);
      });
      vibration.forEach((values, axis) => { part.base[axis].data = { x: turns, y: values }; });
      part.baseMarks.data = { x: marks(turns), y: marks(vibration[0]) };
      const second = this.others[r]?.orbits;
      part.otherOrbit.data = second
        ? this.sized(slice(second.re), slice(second.im)) : { x: [], y: [] };
      const width = run.orders.length;
      const top = place.cascade.slice(at * width, (at + 1) * width).map((v) => this.factor * v);
      part.spectrum.data = { x: run.orders.map((k) => k * Math.abs(now)), top, order: run.orders };
      const row = nearestSorted(run.track.t, t);
      const { xRe, xIm, yRe, yIm } = place.curves;
      part.polarNow.data = { x: [this.factor * xRe[row]], y: [this.factor * xIm[row]] };
      const turn = nearestSorted(run.turns.t, t);
      const whirl = nearestSorted(run.whirl.t, t);
      const few = (values) => values.subarray(Math.max(turn - 8, 0), turn + 8);
      part.pointsNow.data = this.sized(few(place.points.re), few(place.points.im));
      if (r === 0) for (const span of this.spans) span.location = run.stations[this.across][at];
      if (r === this.shownRun) this.cascade.row.location = run.isOneWay ? now : t;
      return {
        hz: now, t, label: place.label, sense: place.sense[whirl], order: place.order[whirl],
        x: this.factor * Math.hypot(xRe[row], xIm[row]), phaseX: degrees(xRe[row], xIm[row]),
        y: this.factor * Math.hypot(yRe[row], yIm[row]), phaseY: degrees(yRe[row], yIm[row]),
        peak: top.reduce((best, v, i) => (v > top[best] ? i : best), 0),
      };
    });
  }
}
