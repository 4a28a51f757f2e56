// Curves as a picture takes them: { x, y }, cut where nothing is to be drawn.

const degrees = (re, im) => (Math.atan2(im, re) * 180) / Math.PI;

// A curve that is not drawn across a reversal of the speed.
function parted(x, y) {
  return { x, y: y.map((v, i) => (i && x[i] * x[i - 1] < 0 ? NaN : v)) };
}

// A phase without the strokes from -180 to 180.
function broken(x, re, im) {
  const y = re.map((value, i) => degrees(value, im[i]));
  return parted(x, y.map((v, i) => (i && Math.abs(v - y[i - 1]) > 180 ? NaN : v)));
}

// The ranges of angles of a contact, from low to high over x, cut where one passes 360.
function ranges(over, touch) {
  const [x, low, high] = [[], [], []];
  touch?.low.forEach((from, i) => {
    const to = from + touch.width[i];
    const cut = to > 360 ? [[from, 360], [0, to - 360]] : [[from, to]];
    for (const [a, b] of cut) {
      if (Number.isFinite(a)) {
        x.push(over[i]);
        low.push(a);
        high.push(b);
      }
    }
  });
  return { x, low, high };
}

// A circle about the middle; none of no radius.
function circle(radius) {
  if (radius === null) return { x: [], y: [] };
  const turn = Array.from({ length: 121 }, (_, i) => (i * Math.PI) / 60);
  return { x: turn.map((a) => radius * Math.cos(a)), y: turn.map((a) => radius * Math.sin(a)) };
}
