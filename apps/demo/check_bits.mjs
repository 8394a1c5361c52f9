// Checks that soil in a browser is bit-identical to its reference, as tests/scene_file/golden_test.cpp for the program:
//
//     node check_bits.mjs FOLDER            containing soil.js and soil.wasm
//
// Reference hashes are those of tests/data/reference_hashes.csv: the rows `unfused`, as the program's SSE4 has them; compiled
// without vectors (cmake -DHAPTOLITH_DEMO_SCALAR=ON) the rows `fused`.

import { existsSync, readFileSync } from 'node:fs';
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
const rows = readFileSync(table, 'utf8').split('\n').map((line) => line.split(','));
const arithmetic = demo.ccall('demoArithmetic', 'string', [], []);
let wrong = 0;
for (const [name, [scene, ticks]] of Object.entries(SCENES)) {
  const [hash, tick_us] = demo.ccall('demoOutcome', 'string', ['string', 'number'], [scene, ticks]).split(' ');
  const golden = rows.find((row) => row[0] === name && row[1] === arithmetic)?.[2] ?? '0';
  const same = BigInt(hash) === BigInt(golden);
  console.log(`${name}, ${arithmetic}: ${hash}, ${tick_us} us a tick${same ? '' : `, not ${golden}`}`);
  wrong += same ? 0 : 1;
}
process.exitCode = wrong === 0 ? 0 : 1;
