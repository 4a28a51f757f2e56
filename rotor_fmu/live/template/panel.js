// The panel of controls: what the machine has, what differs from its file, and the link that says so.

const field = (id) => document.getElementById(id);
const data = JSON.parse(field("data").textContent);
const controls = controlsOf(data);
const byName = new Map(controls.map((control) => [control.name, control]));
const columnOf = new Map(data.recorded.map((each, i) => [each.name, i]));
const values = {}; // SI units, by name, where they differ from the machine file's

const make = (kind, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(kind), properties);
  element.append(...children);
  return element;
};

const SLIDER_STEPS = 1000;

function shareOf({ low, high, log }, value) {
  if (log) return Math.log(Math.max(value, low) / low) / Math.log(high / low);
  return (value - low) / (high - low);
}

function valueAt({ low, high, log }, share) {
  const value = log ? low * (high / low) ** share : low + share * (high - low);
  const size = Math.max(Math.abs(low), Math.abs(high));
  return Math.abs(value) < 1e-9 * size ? 0 : Number(value.toPrecision(3));
}

const shownText = (control, value) => digits(value * control.factor, 6);
const current = (control) => values[control.name] ?? control.start;

// Show a control's value in all of its fields.
function show(control) {
  const { input, range, row } = control;
  const value = current(control);
  const isChanged = control.name in values;
  if (control.kind === "Boolean") input.checked = Boolean(value);
  else if (control.choices.length) input.value = String(value);
  else if (control.unset && !isChanged) input.value = "";
  else input.value = shownText(control, value);
  if (range) {
    range.value = Math.round(SLIDER_STEPS * shareOf(control.slider, value));
    range.setAttribute("aria-valuetext", `${digits(value * control.factor)} ${control.unit}`);
  }
  row.classList.toggle("changed", isChanged);
  if (isChanged) {
    for (let at = row; at; at = at.parentElement.closest("details")) at.open = true;
  }
}

function change(control, value) {
  if (value === control.start) delete values[control.name];
  else values[control.name] = value;
  show(control);
}

function rowOf(control, number) {
  const id = `c${number}`;
  const label = make("label", { htmlFor: id, textContent: control.text, title: control.about });
  const row = (control.row = make("div", { className: "control" }, label));
  let input;
  if (control.kind === "Boolean") {
    input = make("input", { type: "checkbox", id });
    input.addEventListener("change", () => change(control, Number(input.checked)));
  } else if (control.choices.length) {
    const options = control.choices.map((text, i) => make("option", { value: String(i), textContent: text }));
    input = make("select", { id }, ...options);
    input.addEventListener("change", () => change(control, Number(input.value)));
  } else {
    input = make("input", { type: "number", id, step: "any", required: !control.unset });
    if (control.unset) input.placeholder = "as preset";
    input.addEventListener("change", () => {
      const isStart = ["", shownText(control, control.start)].includes(input.value);
      if (isStart) change(control, control.start);
      else change(control, Number(input.value) / control.factor);
    });
  }
  control.input = input;
  row.append(input);
  if (!control.choices.length && control.kind !== "Boolean") {
    row.append(make("span", { className: "unit", textContent: control.unit }));
  }
  if (control.slider) {
    const range = make("input", { type: "range", min: 0, max: SLIDER_STEPS, step: 1 });
    range.setAttribute("aria-label", `${control.text}, ${control.unit}`);
    range.addEventListener("input", () => {
      change(control, valueAt(control.slider, range.value / SLIDER_STEPS));
    });
    row.append((control.range = range));
  }
  return row;
}

function buildControls() {
  controls.forEach(rowOf);
  field("course").append(...data.course.controls.map((control) => control.row));
  const isWide = matchMedia("(min-width: 901px)").matches;
  let open = 0;
  for (const group of data.groups) {
    const usual = group.controls.filter((control) => control.usual);
    const others = group.controls.filter((control) => !control.usual);
    const details = make("details", {}, make("summary", { textContent: group.title }));
    details.append(...usual.map((control) => control.row));
    const rest = others.map((control) => control.row);
    if (usual.length && rest.length) {
      details.append(make("details", {}, make("summary", { textContent: "more" }), ...rest));
    } else details.append(...rest);
    details.open = isWide && usual.length > 0 && open < 4;
    open += usual.length > 0;
    field("groups").append(details);
  }
  controls.forEach(show);
}

// --- the link ---------------------------------------------------------------------------------

function hash() {
  return new URLSearchParams(Object.entries(values).map(([n, v]) => [n, String(v)])).toString();
}

// Take what the address says; what it cannot mean is reported.
function readHash() {
  const unread = [];
  for (const name of Object.keys(values)) delete values[name];
  // a link to the machine file's settings ends in #, with nothing behind it
  if (!location.href.includes("#")) Object.assign(values, data.given);
  for (const [name, text] of new URLSearchParams(location.hash.slice(1))) {
    const control = byName.get(name);
    const value = Number(text);
    if (control && text !== "" && Number.isFinite(value)) values[name] = value;
    else unread.push(`${name} = ${text}, which ${control ? "is no number" : "this machine does not know"}`);
  }
  for (const [name, value] of Object.entries(values)) change(byName.get(name), value);
  controls.forEach(show);
  return unread.map((each) => `The address has ${each}.`);
}
