// What a run takes, of the machine's data and the values that are set: no page is needed for it.

const TURN = 2 * Math.PI;

const controlsOf = (data) => [data.course, ...data.groups].flatMap((group) => group.controls);

// The round number that is nearest: 1, 2 or 5 of a decade.
function round(value) {
  const decade = 10 ** Math.floor(Math.log10(value));
  const far = (each) => Math.abs(Math.log(each / value));
  return [1, 2, 5, 10].map((n) => n * decade).reduce((a, b) => (far(b) < far(a) ? b : a));
}

// values: SI units by the names of controls, those that were changed. Throws a sentence for a course
// of the speed that cannot be.
function planOf(data, values) {
  const start = (name) => data.course.controls.find((c) => c.name === name).start;
  const given = (name) => values[name] ?? start(name);
  const [from, to, rate, hold, samples] = ["from", "to", "rate", "hold", "samples"].map((each) =>
    given(`course.${each}`),
  );
  for (const [name, value] of Object.entries(values)) {
    if (!Number.isFinite(value)) throw new Error(`${name}: must be a finite number`);
  }
  for (const { name, kind } of controlsOf(data)) {
    if (kind !== "Real" && name in values && !Number.isInteger(values[name])) {
      throw new Error(`${name}: must be an integer`);
    }
  }
  if (from !== to && !(rate > 0)) throw new Error("rate of the speed: must be > 0");
  if (!(hold >= 0)) throw new Error("time at the last speed: must be >= 0");
  if (!(samples >= 4)) throw new Error("samples a turn: must be >= 4");
  const ramp = from === to ? 0 : Math.abs(to - from) / rate;
  if (!(ramp + hold > 0)) {
    throw new Error("the run takes no time: choose two speeds, or a time at the last one");
  }
  // at rest no turn tells how fine: as fine as at the machine's own speed
  const fastest = Math.max(Math.abs(from), Math.abs(to)) || start("course.from");
  const wished = Math.min(round(TURN / fastest / samples), ramp + hold);
  const legs = [
    { duration: ramp, from, rate: Math.sign(to - from) * rate },
    { duration: hold, from: to, rate: 0 },
  ]
    .filter((leg) => leg.duration > 0)
    .map(({ duration, ...leg }) => {
      const steps = Math.max(1, Math.round(duration / wished));
      return { ...leg, steps, step: duration / steps };
    });
  const rows = 1 + legs.reduce((sum, leg) => sum + leg.steps, 0);
  if (rows > data.mostRows) {
    throw new Error(
      `the run would have ${Number(rows.toPrecision(7))} points, at most ${data.mostRows} are drawn: ` +
        "choose a faster rate, a shorter time or fewer samples a turn",
    );
  }
  const set = controlsOf(data)
    .filter((control) => control.name in values && control.reference !== null)
    .map((control) => ({ ...control, value: values[control.name] }));
  return {
    values: [
      { reference: data.speed, kind: "Real", value: from },
      { reference: data.speed_rate, kind: "Real", value: legs[0].rate },
      ...set.map(({ reference, kind, value }) => ({ reference, kind, value })),
    ],
    drive: data.speed,
    legs,
    record: data.recorded.map((each) => each.reference),
    rows,
    duration: ramp + hold,
    speeds: [Math.min(from, to), Math.max(from, to)],
  };
}
