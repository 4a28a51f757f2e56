// The picture of full spectra over the speed, as shades.

class Cascade extends Chart {
  constructor(id) {
    super(id, {
      x: "Order of the speed, backward < 0", y: " ", tools: "pan,wheel_zoom,box_zoom,reset", height: 340,
    });
    for (const range of [this.plot.x_range, this.plot.y_range]) range.range_padding = 0;
    this.shades = new Bokeh.LinearColorMapper({ palette: Bokeh.Palettes.Cividis256, low: 0, high: 1 });
    const named = ["image", "x", "y", "dw", "dh"];
    this.tiles = this.source(named);
    this.plot.image({
      ...Object.fromEntries(named.map((name) => [name, { field: name }])),
      source: this.tiles, color_mapper: this.shades,
    });
    this.row = this.span("width"); // the speed that is picked
    this.row.line_color = "#ffffff";
    this.painted.pop();
  }

  // The spectra of a place of a run on an even grid of speeds (of times, where the speed goes both
  // ways); returns the largest amplitude.
  fill(run, place) {
    const down = run.isOneWay ? run.stations.hz : run.stations.t;
    const width = run.orders.length;
    const height = down.length;
    const [low, high] = [Math.min(...down), Math.max(...down)];
    const image = new Float32Array(width * height);
    let largest = 0;
    const { passage } = run.stations;
    const ends = new Map(); // of what each passage shows: nothing is drawn over a reversal
    down.forEach((at, i) => {
      const [a, b] = ends.get(passage[i]) ?? [at, at];
      ends.set(passage[i], [Math.min(a, at), Math.max(b, at)]);
    });
    for (let row = 0; row < height; row++) {
      const at = low + ((row + 0.5) * (high - low)) / height;
      const from = nearest(down, at);
      const [begin, end] = ends.get(passage[from]);
      if (at < begin || at > end) continue;
      for (let k = 0; k < width; k++) {
        // a root shows small lines beside large ones
        const value = Math.sqrt(place.cascade[from * width + k]);
        image[row * width + k] = value;
        if (value > largest) largest = value;
      }
    }
    const [first, last] = [run.orders[0], run.orders[width - 1]];
    const half = (run.orders[1] - first) / 2;
    this.shades.high = largest || 1;
    const { ndarray } = Bokeh.require("core/util/ndarray");
    this.tiles.data = {
      image: [ndarray(image, { dtype: "float32", shape: [height, width] })], x: [first - half],
      y: [low], dw: [last - first + 2 * half], dh: [high - low || 1],
    };
    this.plot.left[0].axis_label = run.isOneWay ? HERTZ : "Time [s]";
    return largest ** 2;
  }
}
