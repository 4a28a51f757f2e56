// A run of the component that jco has made JavaScript of: FOLDER; reads plan.json there and writes rows.
import { readFileSync, writeFileSync } from "node:fs";

const folder = process.argv[2];
const plan = JSON.parse(readFileSync(`${folder}/plan.json`));
const { coSimulation } = await import(`${folder}/component.js`);
const instance = coSimulation.CoSimulationInstance.instantiateCoSimulation(
  "rotor", plan.token, "", false, true, false, false, new Uint32Array());
const names = { Real: "Float64", Integer: "Int32", Boolean: "Boolean" };
const passed = (status) => {
  if (status !== "ok" && status !== "warning") throw new Error(status);
};
for (const { reference, kind, value } of plan.values)
  passed(instance[`set${names[kind]}`]([reference], [kind === "Boolean" ? !!value : value]));
passed(instance.enterInitializationMode(undefined, 0, undefined));
passed(instance.exitInitializationMode());
const rows = [];
const record = (t) => rows.push(t, ...instance.getFloat64(plan.record));
record(0);
let begin = 0;
for (const { steps, step, from, rate } of plan.legs) {
  for (let i = 0; i < steps; i++) {
    const t = begin + i * step;
    passed(instance.setFloat64([plan.drive], [from + rate * i * step]));
    passed(instance.setInputDerivatives([[plan.drive, 1]], [rate]));
    instance.doStep(t, step, true);
    record(t + step);
  }
  begin += steps * step;
}
instance[Symbol.dispose]();
writeFileSync(`${folder}/rows`, new Uint8Array(new Float64Array(rows).buffer));
