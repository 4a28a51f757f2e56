// A run of the page's own scripts in Node: FOLDER [SCRIPT ...]; reads data.json, values.json, wasm and
// table in the folder, writes plan.json and rows, or failure.
import { appendFileSync, readFileSync, writeFileSync } from "node:fs";
import vm from "node:vm";

const [, , folder, ...scripts] = process.argv;
const read = (name) => readFileSync(`${folder}/${name}`);
const context = vm.createContext({ WebAssembly, TextDecoder });
for (const script of scripts) vm.runInContext(readFileSync(script, "utf8"), context);
const plan = context.planOf(JSON.parse(read("data.json")), JSON.parse(read("values.json")));
writeFileSync(`${folder}/plan.json`, JSON.stringify(plan));
await context.work({ wasm: read("wasm"), table: read("table"), plan }, (message) => {
  if (message.rows) appendFileSync(`${folder}/rows`, new Uint8Array(message.rows.buffer, message.rows.byteOffset, message.rows.byteLength));
  if (message.end !== undefined) writeFileSync(`${folder}/end`, message.end);
});
