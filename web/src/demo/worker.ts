// The worker that runs the soil: the program's loop, session and view (apps/demo), compiled to WebAssembly. It runs in
// real time without using the page's thread.

import type { DemoScene, FromWorker, ToWorker } from './messages';

interface DemoModule {
  ccall(name: string, result: 'string', types: 'string'[], values: string[]): string;
  FS: { mkdir(path: string): void; writeFile(path: string, bytes: Uint8Array): void };
  HEAPU8: Uint8Array;
  _malloc(size: number): number;
  _free(at: number): void;
  _demoTurn(now_s: number): number;
  _demoTook(): void;
  _demoTakeFile(at: number, size: number): number;
}

// Interface of the compiler's script in the worker.
declare const haptolithDemo: (options: {
  locateFile(name: string): string;
  toPage(bytes: Uint8Array, binary: number): void;
  settling(time_s: number): void;
}) => Promise<DemoModule>;
declare function importScripts(address: string): void;

const BETWEEN_TURNS_MS = 4; // browsers raise shorter timeouts to this

const scope = self as unknown as {
  postMessage(message: FromWorker | string | ArrayBuffer, transfer?: Transferable[]): void;
  onmessage: ((event: MessageEvent<ToWorker>) => void) | null;
};
const beside = (name: string): string => new URL(name, self.location.href).href;
const tell = (message: FromWorker): void => scope.postMessage(message);

const text_of = new TextDecoder();
const module = (async (): Promise<DemoModule> => {
  importScripts(beside('soil.js'));
  return haptolithDemo({
    locateFile: beside,
    toPage: (bytes, binary) => {
      if (binary) scope.postMessage(bytes.buffer as ArrayBuffer, [bytes.buffer]);
      else scope.postMessage(text_of.decode(bytes));
    },
    settling: (time_s) => tell({ is: 'settling', time_s }),
  });
})();

/** Loads settled soil from the page's server, if it is there; otherwise the soil settles here. */
async function fetchTile(demo: DemoModule, scene: string, changes: string): Promise<void> {
  const tile = demo.ccall('demoTile', 'string', ['string', 'string'], [scene, changes]);
  if (tile === '') return;
  try {
    const answer = await fetch(beside(`tiles/${tile}`));
    if (answer.ok) demo.FS.writeFile(`/tiles/${tile}`, new Uint8Array(await answer.arrayBuffer()));
  } catch {
    // the soil settles here
  }
}

let running = false;
async function run(demo: DemoModule): Promise<void> {
  if (running) return;
  running = true;
  while (demo._demoTurn(performance.now() / 1000)) {
    await new Promise((resolve) => setTimeout(resolve, BETWEEN_TURNS_MS));
  }
  tell({
    is: 'failed',
    why: 'the run has ended, because the simulation became unstable; reload the page',
  });
}

async function open(scene: string, changes: string): Promise<void> {
  const demo = await module;
  demo.FS.mkdir('/tiles');
  const scenes = JSON.parse(demo.ccall('demoScenes', 'string', [], [])) as DemoScene[];
  await fetchTile(demo, scene, changes);
  const why = demo.ccall('demoOpen', 'string', ['string', 'string'], [scene, changes]);
  if (why !== '') return tell({ is: 'failed', why });
  tell({ is: 'opened', scenes });
  void run(demo).catch((error: unknown) => tell({ is: 'failed', why: String(error) }));
}

function takeFile(demo: DemoModule, bytes: ArrayBuffer): number {
  const at = demo._malloc(bytes.byteLength);
  demo.HEAPU8.set(new Uint8Array(bytes), at);
  const number = demo._demoTakeFile(at, bytes.byteLength);
  demo._free(at);
  return number;
}

scope.onmessage = async ({ data }) => {
  try {
    if (data.do === 'open') return await open(data.scene, data.changes);
    const demo = await module;
    if (data.do === 'hear') demo.ccall('demoHear', 'string', ['string'], [data.text]);
    else if (data.do === 'took') demo._demoTook();
    else if (data.do === 'upload') tell({ is: 'uploaded', number: takeFile(demo, data.bytes) });
    else tell({ is: 'changes', text: demo.ccall('demoChanges', 'string', [], []) });
  } catch (error) {
    tell({ is: 'failed', why: String(error) });
  }
};
