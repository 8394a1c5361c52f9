// The demo, which apps/demo/make_demo has put into the folder that HAPTOLITH_DEMO names; skipped where its compiler is
// not installed.

import { execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Browser } from 'playwright-core';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { serveFolder, type Served } from '../static-server';
import { frame, grabTool, holdStill, launch, openPage, pullIntoSoil, scene, violations, type Watched } from './pages';

const FOLDER = process.env.HAPTOLITH_DEMO ?? '';
const MOST_BYTES = 10e6;

/** Makes an animation file of one second with the program that this test is given, as other tests are. */
async function madeFilm(): Promise<Buffer | null> {
  const program = process.env.HAPTOLITH;
  if (!program) return null;
  const folder = await mkdtemp(join(tmpdir(), 'haptolith-film-'));
  try {
    const run = (...words: string[]): void => void execFileSync(program, words, { cwd: folder, stdio: 'ignore' });
    run('run', 'icra2021', '--motion', 'stir', '--duration-s', '1', '--no-serve', '--record', 'run.h5');
    run('export', 'run.h5', '--format', 'film');
    return await readFile(join(folder, 'run.film'));
  } finally {
    await rm(folder, { recursive: true });
  }
}

describe.skipIf(!existsSync(join(FOLDER, 'soil.wasm')))('the demo', () => {
  let browser: Browser;
  let host: Served;
  const open: Watched[] = [];

  async function visit(query = ''): Promise<Watched> {
    const watched = await openPage(browser, host.address + query);
    open.push(watched);
    return watched;
  }

  beforeAll(async () => {
    host = await serveFolder(FOLDER, { '/run.film': await madeFilm() });
    browser = await launch();
  });
  afterEach(async () => {
    for (const { page } of open.splice(0)) await page.close();
  });
  afterAll(async () => {
    await browser?.close();
    await host?.close();
  });

  it('opens lunar soil that has settled, of files that any host serves, and has nothing to complain about', async () => {
    const { page, complaints } = await visit();
    expect((await scene(page)).soil.name).toBe('lunar-0-15cm');
    expect([...host.sent.keys()].some((path) => /^\/tiles\/.*mm-.*\.tile$/.test(path))).toBe(true);
    expect([...host.sent.values()].reduce((sum, bytes) => sum + bytes)).toBeLessThan(MOST_BYTES);
    await page.waitForFunction(
      () => window.haptolith!.status?.simd === 'WASM' && window.haptolith!.frame!.time_s > 0.5,
    );
    expect(await violations(page)).toEqual([]);
    expect(complaints).toEqual([]);
  });

  it('digs: the tool moves, and the soil pushes back', async () => {
    const { page, complaints } = await visit('?scene=icra2021&view=front');
    expect((await scene(page)).particles).toBe(256);
    await holdStill(page);
    const start = await frame(page);
    const at = await grabTool(page);
    await pullIntoSoil(page, at);
    expect((await frame(page)).tool.position_m[2]).toBeLessThan(start.tool.position_m[2] - 0.005);
    await page.mouse.up();
    await page.waitForFunction(() => !window.haptolith!.frame!.held);
    expect(complaints).toEqual([]);
  });

  it('changes the soil, pauses, goes back, and takes a drawing as the tool', async () => {
    const { page, complaints } = await visit('?scene=icra2021');
    await page.selectOption('#soil', 'preset:P1');
    await page.waitForFunction(() => window.haptolith!.scene!.soil.preset === 'P1');
    await page.waitForFunction(() => window.haptolith!.frame!.scene === window.haptolith!.scene!.scene);
    await page.keyboard.press(' ');
    await page.waitForFunction(() => window.haptolith!.status!.paused);
    await page.keyboard.press(' ');
    await page.waitForFunction(() => !window.haptolith!.status!.paused);
    await page.getByRole('button', { name: 'Undo' }).click();
    await page.waitForFunction(() => window.haptolith!.scene!.soil.preset === 'P3');
    const corners = [0, 0.5].flatMap((z) => [0, 4].flatMap((y) => [0, 5].map((x) => `v ${x} ${y} ${z}`)));
    const faces = ['1 3 4 2', '5 6 8 7', '1 2 6 5', '3 7 8 4', '1 5 7 3', '2 4 8 6'].map((f) => `f ${f}`);
    const [chooser] = await Promise.all([
      page.waitForEvent('filechooser'),
      page.getByRole('button', { name: 'Open a mesh file…' }).click(),
    ]);
    const drawing = {
      name: 'plate.obj',
      mimeType: 'text/plain',
      buffer: Buffer.from([...corners, ...faces].join('\n')),
    };
    await chooser.setFiles(drawing);
    await page.locator('#unit').selectOption('10');
    await page.getByRole('button', { name: 'Use it' }).click();
    await page.waitForFunction(() => window.haptolith!.scene!.tool.mesh?.name === 'plate.obj');
    expect(await page.getByRole('button', { name: 'Record' }).isVisible()).toBe(false);
    expect(complaints).toEqual([]);
  });

  it('puts scene and view into its address, from which somebody else sees the same', async () => {
    const { page } = await visit('?scene=icra2021');
    await page.selectOption('#soil', 'preset:P6');
    await page.selectOption('#body', 'Mars');
    await page.waitForFunction(() => window.haptolith!.scene!.soil.preset === 'P6');
    await page.waitForFunction(() => window.haptolith!.scene!.body === 'Mars');
    await page.getByRole('button', { name: 'Share' }).click();
    await page.waitForURL(/names\.preset/);
    const shared = await visit(new URL(page.url()).search);
    const [before, after] = [await scene(page), await scene(shared.page)];
    expect(after.soil).toEqual(before.soil);
    expect(after.gravity_m_s2).toEqual(before.gravity_m_s2);
    expect(after.tool).toEqual(before.tool);
    expect(shared.complaints).toEqual([]);
  });

  it.skipIf(!process.env.HAPTOLITH)('plays a film, which may be looked at anywhere', async () => {
    const { page, complaints } = await visit('?play=run.film');
    await page.waitForFunction(() => window.haptolith!.frame!.time_s > 0.3);
    await page.getByRole('button', { name: 'Stop' }).click();
    await page.getByRole('button', { name: 'Play' }).waitFor();
    const at = (time: string): Promise<unknown> => {
      const place = page.getByRole('slider', { name: 'Time of the animation' });
      return place
        .fill(time)
        .then(() => page.waitForFunction((t) => Math.abs(window.haptolith!.frame!.time_s - t) < 0.2, Number(time)));
    };
    const seen = (): Promise<number[]> => page.evaluate(() => window.haptolith!.frame!.tool.position_m.slice());
    await at('0.9');
    const late = await seen();
    await at('0.2');
    await at('0.9');
    expect(await seen()).toEqual(late);
    await page.getByRole('button', { name: 'Play' }).click();
    await page.waitForFunction(() => window.haptolith!.frame!.time_s > 0.95);
    expect(complaints).toEqual([]);
  });

  it('says why an address shows nothing', async () => {
    const page = await browser.newPage();
    await page.goto(`${host.address}?scene=icra2021&set=soil.radius_mm=-1`);
    await page.getByRole('alert').filter({ hasText: 'soil.radius_mm' }).waitFor();
    await page.goto(`${host.address}?scene=cheese`);
    await page.getByRole('alert').filter({ hasText: 'cheese' }).waitFor();
    await page.getByRole('link', { name: 'Open the first scene' }).waitFor();
    await page.close();
  });
});
