// npm run newcomer -- ADDRESS [right|left|diagonal]: simulates a newcomer who takes the tool with the mouse and drags
// it down and across for ten seconds. Prints the depth of the furrow. The address is that of a running program.

import { decodeFrame, decodeMessage, dequantise, radiiOf, type Scene, SUBPROTOCOL } from 'haptolith-protocol';
import WebSocket from 'ws';
import { launch } from './browser/launch';

const CELL_M = 0.0025;
// Corners of a box are not level initially.
const MARGIN_M = 0.015;
/** Minimum area of a furrow. */
const AREA_M2 = 4e-4;
const DRAG_S = 10;

/** Tracks the particles of a program. */
class Watcher {
  scene: Scene | null = null;
  whole = false;
  strongest_n = 0;
  private positions_m = new Float32Array();
  private readonly socket: WebSocket;

  constructor(address: string) {
    this.socket = new WebSocket(new URL('ws', address.replace(/^http/, 'ws')), SUBPROTOCOL);
    this.socket.binaryType = 'arraybuffer';
    this.socket.on('message', (data, binary) => (binary ? this.read(data as ArrayBuffer) : this.hear(String(data))));
  }

  close(): void {
    this.socket.close();
  }

  /** Returns the height of the soil on a grid, row by row: the upper side of its particles. */
  heights_m(): Float32Array {
    const { box } = this.scene!;
    const radii_m = radiiOf(this.scene!);
    const [columns, rows] = [box.width_m, box.length_m].map((size_m) => Math.round((size_m - 2 * MARGIN_M) / CELL_M));
    const heights_m = new Float32Array(columns! * rows!);
    for (let i = 0; i < radii_m.length; ++i) {
      const [x, y, z] = this.positions_m.subarray(3 * i, 3 * i + 3);
      const radius_m = radii_m[i]!;
      const from = (at_m: number, size_m: number): number => (at_m + size_m / 2 - MARGIN_M) / CELL_M - 0.5;
      const [column, row] = [from(x!, box.width_m), from(y!, box.length_m)];
      const reach = radius_m / CELL_M;
      for (let r = Math.max(0, Math.ceil(row - reach)); r < Math.min(rows!, row + reach); ++r)
        for (let c = Math.max(0, Math.ceil(column - reach)); c < Math.min(columns!, column + reach); ++c) {
          const aside_m = CELL_M * Math.hypot(c - column, r - row);
          if (aside_m > radius_m) continue;
          const height_m = z! + Math.sqrt(radius_m ** 2 - aside_m ** 2);
          heights_m[r * columns! + c] = Math.max(heights_m[r * columns! + c]!, height_m);
        }
    }
    return heights_m;
  }

  private hear(text: string): void {
    const message = decodeMessage(text);
    if (message?.type === 'scene') this.scene = message;
  }

  private read(data: ArrayBuffer): void {
    const frame = decodeFrame(data);
    const { low_m, high_m } = this.scene!.quantised;
    this.strongest_n = Math.max(this.strongest_n, Math.hypot(...frame.force_n));
    if (this.positions_m.length !== 3 * frame.particles) this.positions_m = new Float32Array(3 * frame.particles);
    this.whole ||= frame.whole;
    let record = 0;
    for (let run = 0; run < frame.runs.length; run += 2)
      for (let i = 0; i < frame.runs[run + 1]!; ++i, ++record)
        for (let axis = 0; axis < 3; ++axis)
          this.positions_m[3 * (frame.runs[run]! + i) + axis] = dequantise(
            frame.records[4 * record + axis]!,
            low_m[axis]!,
            high_m[axis]!,
          );
  }
}

const [address, way = 'right'] = process.argv.slice(2);
if (!address) throw new Error('npm run newcomer -- ADDRESS [right|left|diagonal]');
const watcher = new Watcher(address);
const browser = await launch();
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
  await page.goto(address);
  await page.waitForFunction(() => window.haptolith?.ready === true, null, { timeout: 120_000 });
  await page.keyboard.press('l');
  await page.waitForTimeout(3000);
  const before_m = watcher.heights_m();
  const seen = () =>
    page.evaluate(() => {
      const { toolOnScreen, bedOnScreen, frame, scene } = window.haptolith!;
      return { tool: toolOnScreen!, bed: bedOnScreen!, pose: frame!.tool, surface_m: scene!.box.surface_m };
    });
  let { tool, bed, pose, surface_m } = await seen();
  await page.mouse.move(tool.x, tool.y);
  await page.mouse.down();
  ({ tool, bed, pose, surface_m } = await seen());
  const px_per_m = (bed.y - tool.y) / (pose.position_m[2] - surface_m);
  const below = bed.y + 0.03 * px_per_m; // a hand that feels soil continues to push to here
  const aside = 0.05 * px_per_m * (way === 'left' ? -1 : 1);
  const begun_ms = Date.now();
  for (let share = 0; share < 1;) {
    share = Math.min(1, (Date.now() - begun_ms) / (1000 * DRAG_S));
    const down = way === 'diagonal' ? share : Math.min(1, share / 0.3);
    const across = way === 'diagonal' ? share : Math.max(0, (share - 0.3) / 0.7);
    await page.mouse.move(tool.x + across * aside, tool.y + down * (below - tool.y));
    await page.waitForTimeout(30);
  }
  const deepest = (await seen()).pose;
  if (process.env.SHOT) await page.screenshot({ path: process.env.SHOT });
  await page.mouse.up();
  await page.keyboard.press('k');
  await page.waitForTimeout(5000);
  const after_m = watcher.heights_m();
  const dug_m = after_m.map((height_m, i) => before_m[i]! - height_m).sort((a, b) => b - a);
  const furrow_m = dug_m[Math.round(AREA_M2 / CELL_M ** 2)]!;
  console.log(
    `${way}: a furrow of ${(1000 * furrow_m).toFixed(1)} mm over 4 cm2 (deepest ${(1000 * dug_m[0]!).toFixed(1)} mm); ` +
      `tool ${(1000 * (surface_m - deepest.position_m[2])).toFixed(1)} mm deep, at most ${watcher.strongest_n.toFixed(1)} N`,
  );
  if (process.env.SHOT) await page.screenshot({ path: process.env.SHOT.replace('.png', '-after.png') });
} finally {
  watcher.close();
  await browser.close();
}
