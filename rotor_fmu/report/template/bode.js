// The Bode plot's amplitudes: 1x, 2x and 0.5x of a place of each run, and 1x of a second place.

// The lines of a place, and where their data lie.
const LINES = [["1x of x", "bodeX"], ["1x of y", "bodeY"], ["2x", "twice"], ["0.5x", "half"]];
const SECOND = 4; // colour and dash of a second place

class Bode extends Chart {
  // parts: an object a run, which takes the sources of its lines; criticals: speeds [Hz] to mark.
  constructor(parts, { label, xRange, criticals }) {
    super("bode", { x: label, y: " ", xRange, height: 320 });
    this.hovered = [];
    const lone = parts.length === 1;
    parts.forEach((part, r) => {
      LINES.forEach(([name, key], i) => {
        part[key] = this.named(name, lone ? i : r, i, i > 1 ? 1.5 : 2);
      });
      part.second = this.named("second place, 1x of x", SECOND, SECOND, 2);
    });
    this.hover = new Bokeh.HoverTool({ mode: "vline", renderers: this.hovered });
    this.plot.add_tools(this.hover);
    this.criticals = criticals;
    criticals.forEach((hz) => this.mark(hz));
  }

  // The source of a line whose name a tooltip shows.
  named(name, paint, dash, width) {
    const source = this.source(["x", "y"]);
    const renderer = this.line(source, `c${paint}`, dash, { line_width: width });
    renderer.name = name;
    this.hovered.push(renderer);
    return source;
  }

  mark(hz) {
    const span = new Bokeh.Span({
      dimension: "height", location: hz, line_width: 1, line_dash: [2, 4],
    });
    this.plot.add_layout(span);
    this.painted.push([span, { line_color: "soft" }]);
  }

  // A run's lines over x; factor: from µm 0-p to the unit that is shown.
  fill(part, x, place, second, factor) {
    const { xRe, xIm, yRe, yIm, twice, half } = place.curves;
    const long = (re, im) => re.map((value, i) => factor * Math.hypot(value, im[i]));
    part.bodeX.data = parted(x, long(xRe, xIm));
    part.bodeY.data = parted(x, long(yRe, yIm));
    part.twice.data = parted(x, twice.map((v) => factor * v));
    part.half.data = parted(x, half.map((v) => factor * v));
    part.second.data = second
      ? parted(x, long(second.curves.xRe, second.curves.xIm)) : { x: [], y: [] };
  }
}
