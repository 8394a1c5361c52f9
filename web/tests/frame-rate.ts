// npm run frames -- ADDRESS [SECONDS [QUERY]]: measures a page without a graphics card: time to the first frame, frames
// per second after that, and processor time per frame, which is more reliable on a busy machine. The address is that of
// a running program; a query is drawing=balls, for example.
// a query is drawing=balls, for example.

import { readdirSync, readFileSync } from 'node:fs';
import { launch } from './browser/launch';

const SETTLING_S = 15; // the page adapts its resolution
const TICKS_PER_S = 100;

/** Returns the elapsed processor time of a process and all its descendants, in s. */
function processorTime_s(root: number): number {
  const children = new Map<number, number[]>();
  const used_s = new Map<number, number>();
  for (const name of readdirSync('/proc').filter((entry) => /^\d+$/.test(entry))) {
    try {
      const fields = readFileSync(`/proc/${name}/stat`, 'utf8')
        .replace(/^.*\) /, '')
        .split(' ');
      used_s.set(Number(name), (Number(fields[11]) + Number(fields[12])) / TICKS_PER_S);
      const parent = Number(fields[1]);
      children.set(parent, [...(children.get(parent) ?? []), Number(name)]);
    } catch {
      // it has exited
    }
  }
  const sum = (id: number): number =>
    (used_s.get(id) ?? 0) + (children.get(id) ?? []).reduce((total, child) => total + sum(child), 0);
  return sum(root);
}

const [address, seconds = '15', query = ''] = process.argv.slice(2);
if (!address) throw new Error('npm run frames -- ADDRESS [SECONDS [QUERY]]');
const url = new URL(address);
url.search = query;
const browser = await launch();
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
  const begun_ms = performance.now();
  await page.goto(url.href);
  await page.waitForFunction(() => window.haptolith?.ready === true, null, { timeout: 120_000 });
  const first_s = (performance.now() - begun_ms) / 1000;
  await page.waitForTimeout(1000 * SETTLING_S);
  const drawn = (): Promise<[number, number]> =>
    page.evaluate(() => [window.haptolith!.framesDrawn, performance.now() / 1000]);
  const [first, start_s] = await drawn();
  const before_s = processorTime_s(process.pid);
  await page.waitForTimeout(1000 * Number(seconds));
  const [last, end_s] = await drawn();
  const used_s = processorTime_s(process.pid) - before_s;
  const pictures = last - first;
  const canvas = await page.evaluate(() => {
    const { width, height } = document.querySelector<HTMLCanvasElement>('.stage-canvas')!;
    return `${width} x ${height}`;
  });
  console.log(
    `first after ${first_s.toFixed(1)} s, ${(pictures / (end_s - start_s)).toFixed(1)} frames/s of ${canvas} pixels, ` +
      `${((1000 * used_s) / pictures).toFixed(0)} ms of processor time each`,
  );
} finally {
  await browser.close();
}
