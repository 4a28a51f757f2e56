// Pictures as SVG, whose colours are the style sheet's: they follow dark mode and print by themselves.

const SVG = "http://www.w3.org/2000/svg";
const MOST_DIGITS = 5; // of a number beside the upward axis
const MARGIN = { left: 74, right: 26, top: 8, bottom: 40 };

function svg(kind, attributes, parent) {
  const element = document.createElementNS(SVG, kind);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  parent.append(element);
  return element;
}

// As a person reads it: so many digits.
function digits(value, count = 5) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(count))) : "-";
}

// Round numbers between two bounds, about `count` of them: one alone would give no scale.
function ticks(low, high, count) {
  const rough = (high - low) / count;
  const decade = 10 ** Math.floor(Math.log10(rough));
  const step = decade * [1, 2, 5, 10].find((each) => each * decade >= rough);
  const result = [];
  for (let i = Math.ceil(low / step - 1e-9); i <= high / step + 1e-9; i++) result.push(i * step);
  return result.length === 1 ? ticks(low, high, 1.5 * count) : result;
}

// Texts beside an upward axis, short enough for its margin: 2e+6 where one would be longer.
function tickTexts(values) {
  const texts = values.map((value) => digits(value, 6));
  if (!texts.some((text) => text.replace(/\D/g, "").length > MOST_DIGITS)) return texts;
  return values.map((value) => (value ? Number(value.toPrecision(6)).toExponential() : "0"));
}

// Write a label within a length, a long name cut before its unit.
function abbreviate(node, label, length) {
  const [, name, unit] = label.match(/^(.*?)( \[[^\]]*\])?$/);
  node.textContent = label;
  for (let kept = name.length; kept && node.getComputedTextLength() > length; kept--) {
    node.textContent = `${name.slice(0, kept)}…${unit ?? ""}`;
  }
}

function bounds(lists) {
  let [low, high] = [Infinity, -Infinity];
  for (const list of lists) {
    for (const value of list) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (low > high) return [0, 1];
  const size = Math.max(Math.abs(low), Math.abs(high)) || 1;
  return high - low > 1e-9 * size ? [low, high] : [low - 0.5 * size, high + 0.5 * size];
}

function widened([low, high]) {
  const more = 0.04 * (high - low);
  return [low - more, high + more];
}

// The points of a long curve over a growing or falling abscissa that a screen can show: the least and
// the largest of each column of it.
function thinned(x, y, columns) {
  const n = x.length;
  if (n <= 2 * columns) return { x, y };
  const result = { x: [], y: [] };
  for (let c = 0; c < columns; c++) {
    const end = Math.floor(((c + 1) * n) / columns);
    let low = Math.floor((c * n) / columns);
    let high = low;
    for (let i = low; i < end; i++) {
      if (y[i] < y[low]) low = i;
      if (y[i] > y[high]) high = i;
    }
    for (const i of low < high ? [low, high] : [high, low]) {
      result.x.push(x[i]);
      result.y.push(y[i]);
    }
  }
  return result;
}

class Chart {
  constructor(id, onPick) {
    this.figure = document.getElementById(id);
    this.root = svg("svg", { class: "chart", role: "img" }, this.figure);
    this.key = document.createElement("div");
    this.key.className = "key";
    this.figure.append(this.key);
    if (onPick) {
      this.root.addEventListener("click", (event) => {
        const box = this.root.getBoundingClientRect();
        if (this.view) onPick(this.view.valueAt((event.clientX - box.left) / box.width));
      });
    }
  }

  get caption() {
    return this.figure.querySelector("figcaption");
  }

  clear() {
    this.root.replaceChildren();
    this.key.replaceChildren();
    this.view = null;
    this.root.setAttribute("aria-label", `${this.caption.textContent}. Empty.`);
  }

  // series: { x, y, kind, label }, of which `kind` names the style; axes: labels; cursor: abscissa;
  // equal: one scale for both; from: an ordinate that has to be seen.
  draw({ series, xLabel, yLabel, cursor = null, equal = false, from = null, xRange = null }) {
    const width = Math.max(260, Math.round(this.figure.clientWidth));
    const height = Math.round(Math.min(340, Math.max(220, 0.62 * width)));
    this.root.replaceChildren();
    this.root.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const inner = { x: width - MARGIN.left - MARGIN.right, y: height - MARGIN.top - MARGIN.bottom };
    let xs = xRange ?? bounds(series.map((each) => each.x));
    let ys = widened(bounds([...series.map((each) => each.y), from === null ? [] : [from]]));
    if (equal) {
      xs = widened(xs);
      const scale = Math.max((xs[1] - xs[0]) / inner.x, (ys[1] - ys[0]) / inner.y);
      const about = ([low, high], size) => [
        (low + high - scale * size) / 2,
        (low + high + scale * size) / 2,
      ];
      [xs, ys] = [about(xs, inner.x), about(ys, inner.y)];
    }
    const atX = (value) => MARGIN.left + ((value - xs[0]) / (xs[1] - xs[0])) * inner.x;
    const atY = (value) => MARGIN.top + inner.y - ((value - ys[0]) / (ys[1] - ys[0])) * inner.y;
    const bottom = MARGIN.top + inner.y;
    for (const value of ticks(...xs, Math.max(3, inner.x / 90))) {
      const x = atX(value).toFixed(1);
      svg("path", { class: "grid-line", d: `M${x} ${MARGIN.top}V${bottom}` }, this.root);
      const label = svg("text", { x, y: bottom + 16, "text-anchor": "middle" }, this.root);
      label.textContent = digits(value, 6);
    }
    const up = ticks(...ys, Math.max(3, inner.y / 45));
    const texts = tickTexts(up);
    for (const [i, value] of up.entries()) {
      const y = atY(value);
      const d = `M${MARGIN.left} ${y.toFixed(1)}h${inner.x}`;
      svg("path", { class: "grid-line", d }, this.root);
      const place = { x: MARGIN.left - 6, y: (y + 4).toFixed(1), "text-anchor": "end" };
      svg("text", place, this.root).textContent = texts[i];
    }
    const below = { x: MARGIN.left + inner.x / 2, y: height - 6, "text-anchor": "middle" };
    svg("text", below, this.root).textContent = xLabel;
    const middle = MARGIN.top + inner.y / 2;
    const turned = { transform: `translate(13 ${middle}) rotate(-90)`, "text-anchor": "middle" };
    abbreviate(svg("text", turned, this.root), yLabel, inner.y);
    for (const { x, y, kind } of series) {
      let d = "";
      for (let i = 0; i < x.length; i++) {
        if (!Number.isFinite(y[i])) continue;
        d += `${d ? "L" : "M"}${atX(x[i]).toFixed(1)} ${atY(y[i]).toFixed(1)}`;
      }
      svg("path", { class: kind, d }, this.root);
    }
    if (cursor !== null && cursor >= Math.min(...xs) && cursor <= Math.max(...xs)) {
      const d = `M${atX(cursor).toFixed(1)} ${MARGIN.top}V${bottom}`;
      svg("path", { class: "cursor", d }, this.root);
    }
    const frame = { class: "frame", x: MARGIN.left, y: MARGIN.top, width: inner.x, height: inner.y };
    svg("rect", frame, this.root);
    this.view = {
      xs,
      ys,
      valueAt: (share) => xs[0] + ((share * width - MARGIN.left) / inner.x) * (xs[1] - xs[0]),
    };
    this.key.replaceChildren();
    const said = [];
    for (const { kind, label, y } of series) {
      if (!label) continue;
      const entry = document.createElement("span");
      entry.className = `is-${kind}`;
      entry.textContent = label;
      this.key.append(entry);
      const [low, high] = bounds([y]);
      said.push(`${label}: ${digits(low, 4)} to ${digits(high, 4)}`);
    }
    this.root.setAttribute("aria-label", `${this.caption.textContent}. ${yLabel} over ${xLabel}. ${said.join("; ")}`);
  }
}
