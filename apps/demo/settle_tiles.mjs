// Settles the soil of the demo's scenes and stores it next to the page, so that the page opens without delay:
//
//     node settle_tiles.mjs FOLDER      containing soil.js and soil.wasm; writes FOLDER/tiles

import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join, resolve } from 'node:path';

const folder = resolve(process.argv[2]);
const haptolithDemo = createRequire(import.meta.url)(join(folder, 'soil.js'));
const demo = await haptolithDemo({
  wasmBinary: readFileSync(join(folder, 'soil.wasm')),
  toPage() {},
  settling() {},
});
const call = (name, ...texts) => demo.ccall(name, 'string', texts.map(() => 'string'), texts);

demo.FS.mkdir('/tiles');
mkdirSync(join(folder, 'tiles'), { recursive: true });
for (const { name, title } of JSON.parse(call('demoScenes'))) {
  const tile = call('demoTile', name, '');
  if (tile === '' || tile.endsWith('.tile')) continue; // ships with the program
  console.error(`${title}: its soil settles`);
  const why = call('demoOpen', name, '');
  if (why !== '') throw new Error(`${name}: ${why}`);
  writeFileSync(join(folder, 'tiles', tile), demo.FS.readFile(join('/tiles', tile)));
}
