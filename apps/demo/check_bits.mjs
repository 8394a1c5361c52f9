// Checks that soil in a browser is bit-identical to its reference, as tests/scene_file/golden_test.cpp for the program:
//
//     node check_bits.mjs FOLDER            containing soil.js and soil.wasm
//
// Reference hashes are the rows `WebAssembly` of tests/data/reference_hashes.csv; HAPTOLITH_RENEW_HASHES=1 updates them
// (./dev hashes). They differ from those for AVX and SSE, because WebAssembly has no approximate reciprocals and another
// C library's sines (docs/how-to/share-in-a-browser.md).

import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const SCENES = {
  Icra2021Scoop: ['[hand]\nmotion = "scoop"', 8000],
  Icra2021Stir: ['[hand]\nmotion = "stir"', 8000],
  LunarStir: ['[soil]\nname = "lunar-0-15cm"\n[hand]\nmotion = "stir"', 4000],
  Rain: ['[bed]\nstart = "rain"\nparticles = 300\nseed = 7\n[hand]\nmotion = "stir"', 8000],
};

const folder = resolve(process.argv[2]);
if (!existsSync(join(folder, 'soil.wasm'))) process.exit(77); // not compiled on this machine
const demo = await createRequire(import.meta.url)(join(folder, 'soil.js'))({
  wasmBinary: readFileSync(join(folder, 'soil.wasm')),
  toPage() {},
  settling() {},
});
const table = fileURLToPath(new URL('../../tests/data/reference_hashes.csv', import.meta.url));
let text = readFileSync(table, 'utf8');
let wrong = 0;
for (const [name, [scene, ticks]] of Object.entries(SCENES)) {
  const [hash, tick_us] = demo.ccall('demoOutcome', 'string', ['string', 'number', 'number'], [scene, ticks, 0]).split(' ');
  const row = `${name},WebAssembly,`;
  const golden = text.split('\n').find((line) => line.startsWith(row))?.slice(row.length);
  const same = hash === golden;
  console.log(`${name}: ${hash}, ${tick_us} us a tick${same ? '' : `, not ${golden}`}`);
  if (!same && process.env.HAPTOLITH_RENEW_HASHES) {
    console.log(`changed: ${name}, WebAssembly: ${golden} -> ${hash}`);
    text = text.replace(row + golden, row + hash);
    writeFileSync(table, text);
  } else {
    wrong += same ? 0 : 1;
  }
}
// Compiled without vectors (cmake -DHAPTOLITH_DEMO_SCALAR=ON) it must equal the program's SCALAR.
const cut = (scene) => demo.ccall('demoOutcome', 'string', ['string', 'number', 'number'], [scene, 2000, 1]);
const cuts = [cut('[soil]\npreset = "P3"'), cut('[soil]\nname = "lunar-0-15cm"')];
console.log(`straight cut of P3 and lunar-0-15cm: ${cuts.join(', ')}`);
process.exitCode = wrong === 0 ? 0 : 1;
