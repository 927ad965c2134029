// Spreads points over a mesh file in Node: node example.mjs MESH [NUMBER]
import { readFile } from "node:fs/promises";
import { basename } from "node:path";
import init, { wrap, wrapShape } from "./ldwrap_web.js";

await init({ module_or_path: await readFile(new URL("ldwrap_web_bg.wasm", import.meta.url)) });

const [path, count = "1000"] = process.argv.slice(2);
const options = { request: { count: Number(count) } };
const { positions, report } = path
  ? wrap(await readFile(path), basename(path), options)
  : wrapShape("cup", options);

console.error(`${positions.length / 3} points on ${report.strips.length} strips`);
for (let i = 0; i < positions.length; i += 3) {
  console.log(positions[i], positions[i + 1], positions[i + 2]);
}
