// A signal over time: every sample where the screen has room, else the extremes of each stretch.

// Samples from..to of v thinned to the least and the largest of each of `stretches` of time.
function thinned(t, v, from, to, stretches) {
  if (to - from <= 2 * stretches) return { x: t.slice(from, to), y: v.slice(from, to) };
  const x = [];
  const y = [];
  const scale = stretches / (t[to - 1] - t[from]);
  let begin = from;
  while (begin < to) {
    const stretch = Math.floor((t[begin] - t[from]) * scale);
    let least = begin;
    let largest = begin;
    let i = begin + 1;
    for (; i < to && Math.floor((t[i] - t[from]) * scale) === stretch; i++) {
      if (v[i] < v[least]) least = i;
      else if (v[i] > v[largest]) largest = i;
    }
    const [first, second] = least < largest ? [least, largest] : [largest, least];
    x.push(t[first]);
    y.push(v[first]);
    if (second !== first) {
      x.push(t[second]);
      y.push(v[second]);
    }
    begin = i;
  }
  return { x, y };
}

class TimeChart {
  // runs: for each its name and what signals.py packed
  constructor(runs) {
    this.runs = runs.map((run) => ({ ...run, kept: new Map() }));
    this.range = new Bokeh.Range1d({ start: 0, end: 1 });
    this.heights = new Bokeh.Range1d({ start: 0, end: 1 });
    this.chart = new Chart("time", {
      x: "Time [s]", y: " ", xRange: this.range, yRange: this.heights, height: 320,
    });
    this.sources = this.runs.map((run, r) => {
      const source = this.chart.source(["x", "y"]);
      this.chart.line(source, `c${r}`, r, { line_width: 1 });
      this.chart.dots(source, `c${r}`, 4, { visible: false });
      return source;
    });
    this.dots = this.chart.plot.renderers.filter((r) => r.glyph instanceof Bokeh.Scatter);
    this.span = this.chart.span("height");
    for (const end of ["start", "end"]) {
      this.range.properties[end].change.connect(() => this.later());
    }
    this.chart.onTap((t) => this.point(t));
  }

  // Take a signal by its number; unpacked when it is first looked at.
  async choose(index) {
    const name = this.runs[0].signals[index].name;
    this.shown = await Promise.all(this.runs.map((run) => this.take(run, name)));
    const head = this.runs[0].signals[index];
    this.label = head.label;
    this.unit = head.unit;
    this.chart.plot.left[0].axis_label = verbatim(`${head.label} [${head.unit}]`);
    const every = Math.max(...this.shown.map((signal) => signal?.every ?? 1));
    const kept = every > 1 ? `least and largest of each ${Math.round(every)} steps` : "every step";
    this.chart.name([...this.runs.map((run, r) => [run.name, `c${r}`, r]), [kept, "ground"]]);
    this.draw();
  }

  async take(run, name) {
    const entry = run.signals.find((signal) => signal.name === name);
    if (!entry) return null;
    if (!run.kept.has(name)) {
      run.time ??= run.t && (await unpack(run.t));
      const t = entry.t ? await unpack(entry.t) : run.time;
      run.kept.set(name, { t, v: await unpack(entry.v), every: entry.every });
    }
    return run.kept.get(name);
  }

  get whole() {
    const ends = this.shown.filter(Boolean).map((signal) => signal.t[signal.t.length - 1]);
    return [0, Math.max(...ends, 1e-9)];
  }

  view(from, to) {
    const [first, last] = this.whole;
    const width = Math.min(Math.max(to - from, 1e-7 * (last - first)), last - first);
    const start = Math.min(Math.max(from, first), last - width);
    this.range.setv({ start, end: start + width });
    this.draw();
  }

  // factor of the width about the cursor, where it is in view, or about the middle
  zoom(factor) {
    const { start, end } = this.range;
    const at = this.at >= start && this.at <= end ? this.at : (start + end) / 2;
    this.view(at - (at - start) * factor, at + (end - at) * factor);
  }

  move(share) {
    const { start, end } = this.range;
    this.view(start + share * (end - start), end + share * (end - start));
  }

  later() {
    this.waiting ??= requestAnimationFrame(() => {
      this.waiting = null;
      this.draw();
    });
  }

  draw() {
    if (!this.shown) return;
    const { start, end } = this.range;
    const stretches = Math.max(200, this.chart.holder.clientWidth);
    let [low, high, most] = [Infinity, -Infinity, 0];
    this.shown.forEach((signal, r) => {
      if (!signal) {
        this.sources[r].data = { x: [], y: [] };
        return;
      }
      const from = Math.max(nearestSorted(signal.t, start) - 1, 0);
      const to = Math.min(nearestSorted(signal.t, end) + 2, signal.t.length);
      const data = thinned(signal.t, signal.v, from, to, stretches);
      for (const y of data.y) {
        if (y < low) low = y;
        if (y > high) high = y;
      }
      most = Math.max(most, data.x.length);
      this.sources[r].data = data;
    });
    // round-off alone is no signal: a constant is a straight line
    const size = Math.max(Math.abs(low), Math.abs(high));
    const margin = high - low > 1e-9 * size ? 0.05 * (high - low) : 0.5 * size || 1;
    if (Number.isFinite(low)) this.heights.setv({ start: low - margin, end: high + margin });
    for (const dots of this.dots) dots.visible = most < 250;
    this.chart.describe(
      `${this.label} from ${shown(start)} to ${shown(end)} s lies between ${shown(low)} and ` +
      `${shown(high)} ${this.unit}.`,
    );
  }

  // The cursor to the sample nearest to t.
  point(t) {
    const signal = this.shown.find(Boolean);
    this.at = signal.t[nearestSorted(signal.t, t)];
    this.span.location = this.at;
    const values = this.shown.map((each, r) => {
      if (!each) return "";
      const i = nearestSorted(each.t, t);
      const name = this.runs.length > 1 ? `${this.runs[r].name}: ` : "";
      return `${name}${shown(each.v[i])} ${this.unit}`;
    });
    const field = document.getElementById("cursor");
    if (document.activeElement !== field) field.value = this.at.toFixed(6);
    document.getElementById("value").textContent =
      `${this.label} at ${this.at.toFixed(6)} s: ${values.filter(Boolean).join("; ")}`;
  }
}
