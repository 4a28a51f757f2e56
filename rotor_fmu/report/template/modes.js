// Mode shapes that turn: the shaft, and the orbits of its nodes, in parallel projection.
const shapes = JSON.parse(document.getElementById("data").textContent).shapes;
const canvas = document.getElementById("shape");
const chosen = document.getElementById("mode");
const running = document.getElementById("running");
const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
const colour = { forward: "--c0", backward: "--c1", mixed: "--c2" };
let angle = -0.6, tilt = 0.35, phase = 0, last = null, drag = null;

shapes.modes.forEach((mode, i) => {
  const option = document.createElement("option");
  option.value = i;
  option.textContent = mode.caption;
  chosen.append(option);
});
running.checked = !still;

function style(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function draw() {
  const mode = shapes.modes[chosen.value || 0], z = shapes.z;
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  const from = z[0], length = z[z.length - 1] - z[0], size = 0.18;
  const scale = Math.min(width / 1.15, height * 1.6);
  const project = (at, x, y) => {
    const along = (at - from) / length - 0.5;
    const across = along * Math.sin(angle) + x * size * Math.cos(angle);
    return [
      width / 2 + scale * (along * Math.cos(angle) - x * size * Math.sin(angle)),
      height / 2 - scale * (y * size * Math.cos(tilt) + across * Math.sin(tilt)),
    ];
  };
  const moved = (i, p) => {
    const c = Math.cos(p), s = Math.sin(p);
    return [mode.x[0][i] * c - mode.x[1][i] * s, mode.y[0][i] * c - mode.y[1][i] * s];
  };
  const line = (points, name, thick) => {
    pen.strokeStyle = style(name);
    pen.lineWidth = thick;
    pen.beginPath();
    points.forEach((p, i) => (i ? pen.lineTo(...p) : pen.moveTo(...p)));
    pen.stroke();
  };
  line([project(z[0], 0, 0), project(z[z.length - 1], 0, 0)], "--soft", 1);
  shapes.marked.forEach((i) => {
    const orbit = [];
    for (let k = 0; k <= 48; k++) orbit.push(project(z[i], ...moved(i, (k * Math.PI) / 24)));
    line(orbit, colour[mode.whirl] || "--soft", 1);
  });
  const shaft = z.map((at, i) => project(at, ...moved(i, phase)));
  line(shaft, "--ink", 2.5);
  pen.fillStyle = style("--ink");
  shapes.marked.forEach((i) => {
    pen.beginPath();
    pen.arc(...shaft[i], 3, 0, 2 * Math.PI);
    pen.fill();
  });
}

function turn(time) {
  if (running.checked) {
    if (last !== null) phase += (time - last) * 0.002;
    last = time;
    draw();
    requestAnimationFrame(turn);
  } else last = null;
}

chosen.addEventListener("change", draw);
running.addEventListener("change", () => requestAnimationFrame(turn));
window.addEventListener("resize", draw);
window.addEventListener("beforeprint", draw);
canvas.addEventListener("pointerdown", (event) => {
  drag = [event.clientX, event.clientY];
  canvas.setPointerCapture(event.pointerId);
});
canvas.addEventListener("pointermove", (event) => {
  if (!drag) return;
  angle += (event.clientX - drag[0]) * 0.01;
  tilt += (event.clientY - drag[1]) * 0.01;
  drag = [event.clientX, event.clientY];
  draw();
});
canvas.addEventListener("pointerup", () => (drag = null));
draw();
requestAnimationFrame(turn);
