// One picture in the page's colours: Bokeh draws, the page gives the data, says what is seen and
// lists the lines' names below the caption.

const DASHES = ["solid", [7, 4], [2, 3], [9, 3, 2, 3], [12, 4], [3, 6]];
const CHARTS = [];

Bokeh.logger.set_level("warn");

const colour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

// Numbers in tooltips, of five digits whatever their size.
const significant = (factor = 1) => new Bokeh.CustomJSHover({
  code: `return String(Number((${factor} * value).toPrecision(5)))`,
});

// A name as it is, whatever stands in it: Bokeh takes some letters for formulas.
const verbatim = (text) => new Bokeh.PlainText({ text });

class Chart {
  // options: x, y: labels; tools; square: one scale on both axes; xRange, yRange: of its own
  constructor(id, options) {
    this.figure = document.getElementById(id);
    this.caption = this.figure.querySelector("figcaption").textContent;
    this.holder = document.createElement("div");
    this.holder.setAttribute("role", "img");
    this.legend = document.createElement("div");
    this.legend.className = "legend";
    this.figure.append(this.legend, this.holder);
    this.painted = [];
    this.plot = Bokeh.Plotting.figure({
      height: options.height ?? 300,
      sizing_mode: "stretch_width",
      tools: options.tools ?? "xpan,xwheel_zoom,xbox_zoom,reset",
      x_axis_label: options.x,
      y_axis_label: options.y,
      match_aspect: options.square ?? false,
      ...(options.xRange ? { x_range: options.xRange } : {}),
      ...(options.yRange ? { y_range: options.yRange } : {}),
    });
    // the wheel zooms about the pointer, dragging selects, a double click shows all again
    const tool = (kind) => this.plot.toolbar.tools.find((each) => each instanceof kind) ?? null;
    this.plot.toolbar.active_scroll = tool(Bokeh.WheelZoomTool);
    this.plot.toolbar.active_drag = tool(Bokeh.BoxZoomTool);
    this.plot.on_event("doubletap", () => this.plot.reset.emit());
    this.plot.toolbar.logo = null;
    this.plot.toolbar.autohide = true;
    CHARTS.push(this);
  }

  // A source of data that `draw` fills.
  source(columns) {
    const data = Object.fromEntries(columns.map((name) => [name, []]));
    return new Bokeh.ColumnDataSource({ data });
  }

  line(source, paint, dash = 0, options = {}) {
    const glyph = this.plot.line({ field: "x" }, { field: "y" }, {
      source, line_width: 2, line_dash: DASHES[dash % DASHES.length], ...options,
    });
    return this.keep(glyph, { line_color: paint });
  }

  dots(source, paint, size = 4, options = {}) {
    const glyph = this.plot.scatter({ field: "x" }, { field: "y" }, {
      source, size, line_color: null, ...options,
    });
    return this.keep(glyph, { fill_color: paint });
  }

  // A line across at a value that is picked.
  span(dimension) {
    const span = new Bokeh.Span({ dimension, location: NaN, line_width: 1.5, line_dash: [4, 3] });
    this.plot.add_layout(span);
    this.painted.push([span, { line_color: "mark" }]);
    return span;
  }

  keep(glyph, paints) {
    this.painted.push([glyph.glyph, paints]);
    return glyph;
  }

  // Names of the lines: [text, colour, dash]
  name(entries) {
    this.legend.replaceChildren(
      ...entries.map(([text, paint, dash]) => {
        const entry = document.createElement("span");
        const dashes = [DASHES[(dash ?? 0) % DASHES.length]].flat().join(" ");
        const stroke = `stroke="var(--${paint})" stroke-dasharray="${dash ? dashes : ""}"`;
        entry.innerHTML =
          `<svg width="30" height="8" aria-hidden="true"><path d="M0 4H30" ${stroke}/></svg> `;
        entry.append(text);
        return entry;
      }),
    );
  }

  // The text for a person who does not see the picture.
  describe(text) {
    this.holder.setAttribute("aria-label", `${this.caption}. ${text}`);
  }

  async show() {
    this.paint();
    this.view = await Bokeh.Plotting.show(this.plot, this.holder);
  }

  paint() {
    const [ground, ink, soft, line] = ["ground", "ink", "soft", "line"].map(colour);
    this.plot.setv({
      background_fill_color: ground, border_fill_color: ground, outline_line_color: line,
    });
    for (const axis of [...this.plot.left, ...this.plot.below]) {
      axis.setv?.({
        axis_line_color: soft, major_tick_line_color: soft, minor_tick_line_color: null,
        major_label_text_color: ink, axis_label_text_color: ink,
        axis_label_text_font_style: "normal",
      });
    }
    for (const grid of this.plot.center) {
      if (grid instanceof Bokeh.Grid) grid.grid_line_color = line;
    }
    for (const [thing, paints] of this.painted) {
      for (const [property, name] of Object.entries(paints)) thing[property] = colour(name);
    }
  }

  onTap(act) {
    this.plot.on_event("tap", (event) => act(event.x, event.y));
  }
}

// Let the x axes of charts, each with a Range1d of its own, go together.
function link(charts) {
  const ranges = charts.map((chart) => chart.plot.x_range);
  for (const range of ranges) {
    const follow = () => {
      const { start, end } = range;
      for (const other of ranges) {
        if (other.start !== start || other.end !== end) other.setv({ start, end });
      }
    };
    range.properties.start.change.connect(follow);
    range.properties.end.change.connect(follow);
  }
}

// A range that no zoom leaves.
const fixedRange = (start, end) =>
  new Bokeh.Range1d({ start, end, reset_start: start, reset_end: end, bounds: [start, end] });

const repaint = () => CHARTS.forEach((chart) => chart.paint());
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
matchMedia("print").addEventListener("change", repaint);
