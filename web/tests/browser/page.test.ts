import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import type { Browser } from 'playwright-core';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { frame, grabTool, holdStill, launch, openPage, pullIntoSoil, scene, type Watched } from './pages';
import { portOf, startProgram, type Program } from './program';

/** A plate of 5 by 4 by 0.5. */
const PLATE = [
  ...[0, 0.5].flatMap((z) => [0, 4].flatMap((y) => [0, 5].map((x) => `v ${x} ${y} ${z}`))),
  ...['1 3 4 2', '5 6 8 7', '1 2 6 5', '3 7 8 4', '1 5 7 3', '2 4 8 6'].map((corners) => `f ${corners}`),
].join('\n');

let browser: Browser;
let program: Program;
const open: Watched[] = [];

async function visit(query = '', script?: { content: string }): Promise<Watched> {
  const watched = await openPage(browser, program.address + query, script);
  open.push(watched);
  return watched;
}

beforeAll(async () => {
  program = await startProgram();
  browser = await launch();
});

afterEach(async () => {
  for (const { page } of open.splice(0)) await page.close();
});

afterAll(async () => {
  await browser?.close();
  await program?.stop();
});

describe('the page', () => {
  it('shows all particles and has nothing to complain about', async () => {
    const { page, complaints } = await visit();
    const { particles } = await scene(page);
    expect(particles).toBeGreaterThan(100);
    expect(await page.evaluate(() => window.haptolith!.particlesDrawn)).toBe(particles);
    const drawn = await page.evaluate(() => window.haptolith!.framesDrawn);
    await page.waitForFunction((before) => window.haptolith!.framesDrawn > before + 2, drawn);
    for (const mode of ['force', 'speed', 'depth', 'sleep', 'plain'] as const) {
      await page.evaluate((name) => window.haptolith!.setColour(name), mode);
      const legend = page.locator('.legend');
      if (mode === 'plain') await legend.waitFor({ state: 'hidden' });
      else await legend.waitFor({ state: 'visible' });
    }
    expect(complaints).toEqual([]);
  });

  it('takes view, colours, theme and panels from its address', async () => {
    const { page } = await visit('?view=top&colour=depth&theme=light&panels=0');
    expect(await page.locator('html').getAttribute('data-theme')).toBe('light');
    await page.locator('.legend').waitFor({ state: 'visible' });
    expect(await page.locator('.controls').isVisible()).toBe(false);
    await page.evaluate(() => window.haptolith!.hidePanels(false));
    await page.locator('.controls').waitFor({ state: 'visible' });
  });

  it('shows no timing in a picture, during which time stands still', async () => {
    const { page } = await visit('?quality=full');
    const cells = page.locator('.cells');
    expect(await cells.getByText('soil', { exact: true }).count()).toBe(1);
    for (const name of ['rate', 'ticks in time, last 10 s', 'tick p99', 'priority']) {
      expect(await cells.getByText(name, { exact: true }).count(), name).toBe(0);
    }
    expect(await page.evaluate(() => window.haptolith!.connected)).toBe(true);
  });

  it('lets the mouse dig: the tool moves, the soil pushes back, the readout shows it', async () => {
    const { page, complaints } = await visit('?view=front');
    await holdStill(page);
    const readout = page.locator('[data-test=force]');
    const start = await frame(page);
    const at = await grabTool(page);
    await pullIntoSoil(page, at);
    expect((await frame(page)).tool.position_m[2]).toBeLessThan(start.tool.position_m[2] - 0.005);
    await page.waitForFunction(() => Number(document.querySelector('[data-test=force]')!.textContent!.trim()) > 0.04);
    expect(await readout.textContent()).toMatch(/\d\.\d\d/);
    await page.mouse.up();
    await page.waitForFunction(() => !window.haptolith!.frame!.held);
    expect(complaints).toEqual([]);
  });

  it('moves and turns the tool by keys', async () => {
    const { page } = await visit();
    await holdStill(page);
    const before = await frame(page);
    await page.keyboard.down('PageUp');
    await page.waitForFunction(
      (z) => window.haptolith!.frame!.tool.position_m[2] > z + 0.004,
      before.tool.position_m[2],
    );
    await page.keyboard.up('PageUp');
    await page.keyboard.down('q');
    await page.waitForFunction(
      (z) => Math.abs(window.haptolith!.frame!.tool.rotation[3] - z) > 0.05,
      before.tool.rotation[3],
    );
    await page.keyboard.up('q');
    await page.waitForFunction(() => !window.haptolith!.frame!.held);
  });

  it('changes soil and body, resets and takes the reset back', async () => {
    const { page, complaints } = await visit();
    const before = await scene(page);
    await page.selectOption('#body', 'Mars');
    await page.waitForFunction(() => window.haptolith!.scene!.body === 'Mars');
    expect((await scene(page)).gravity_m_s2[2]).toBeCloseTo(-3.72, 1);
    expect((await scene(page)).scene).toBe(before.scene);

    await page.selectOption('#soil', 'preset:P1');
    await page.waitForFunction(() => window.haptolith!.scene!.soil.preset === 'P1');
    await page.waitForFunction((old) => window.haptolith!.scene!.scene > old, before.scene);
    await page.waitForFunction(() => window.haptolith!.frame!.scene === window.haptolith!.scene!.scene);

    await page.getByRole('button', { name: 'Reset', exact: true }).click();
    await page.waitForFunction(
      (old) => window.haptolith!.scene!.body === old.body && window.haptolith!.scene!.soil.preset === old.soil.preset,
      before,
    );
    await page.getByRole('button', { name: 'Undo reset' }).click();
    await page.waitForFunction(() => window.haptolith!.scene!.soil.preset === 'P1');
    await page.waitForFunction(() => window.haptolith!.particlesDrawn === window.haptolith!.scene!.particles);
    expect(complaints).toEqual([]);
  });

  it('digs with a drawing that is chosen, or dropped on it', async () => {
    const { page, complaints } = await visit();
    const tool = async (): Promise<string> => {
      const { shape, mesh } = (await scene(page)).tool;
      return `${shape} ${mesh?.name ?? ''}`;
    };
    const dialog = page.locator('.question-dialog');
    const [chooser] = await Promise.all([
      page.waitForEvent('filechooser'),
      page.getByRole('button', { name: 'Open a mesh file…' }).click(),
    ]);
    await chooser.setFiles({ name: 'notes.txt', mimeType: 'text/plain', buffer: Buffer.from('no mesh') });
    await page.getByText('notes.txt is not a mesh file').waitFor();
    await chooser.setFiles({ name: 'plate.obj', mimeType: 'model/obj', buffer: Buffer.from(PLATE) });
    await dialog.getByLabel('Unit of the file').selectOption('centimetres');
    await dialog.getByRole('button', { name: 'Use it' }).click();
    await expect.poll(tool, { timeout: 60_000 }).toBe('mesh plate.obj');

    const drop = await page.evaluateHandle(
      (text) => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([text], 'dropped.obj'));
        return transfer;
      },
      PLATE.replaceAll(' 0.5', ' 0.4'),
    );
    await page.dispatchEvent('body', 'dragenter', { dataTransfer: drop });
    await page.getByText('Drop a mesh file here').waitFor();
    await page.dispatchEvent('body', 'drop', { dataTransfer: drop });
    await dialog.getByLabel('Unit of the file').selectOption('centimetres');
    await dialog.getByRole('button', { name: 'Use it' }).click();
    await expect.poll(tool, { timeout: 60_000 }).toBe('mesh dropped.obj');
    expect(await page.getByText('Drop a mesh file here').isVisible()).toBe(false);
    await page.keyboard.press('r');
    expect(complaints).toEqual([]);
  });

  it('opens the help and pauses by keys', async () => {
    const { page } = await visit();
    await page.keyboard.press('?');
    await page.getByRole('dialog').waitFor({ state: 'visible' });
    const licences = await page.getByRole('link', { name: /Licences/ }).getAttribute('href');
    const told = await page.evaluate(async (at) => (await fetch(at)).text(), licences!);
    for (const name of ['three', 'uplot', 'valibot']) expect(told).toContain(`\n${name} `.trimStart());
    await page.keyboard.press('Escape');
    await page.getByRole('dialog').waitFor({ state: 'hidden' });

    await page.keyboard.press(' ');
    await page.waitForFunction(() => window.haptolith!.status!.paused && window.haptolith!.frame!.paused);
    const { time_s } = await frame(page);
    await page.keyboard.press('.');
    await page.waitForFunction((before) => window.haptolith!.frame!.time_s > before, time_s);
    expect((await frame(page)).time_s).toBeCloseTo(time_s + 0.001, 6);
    await page.keyboard.press(' ');
    await page.waitForFunction(() => !window.haptolith!.status!.paused);
  });

  it('tells a second browser who holds the tool', async () => {
    const first = (await visit('?view=front')).page;
    const second = (await visit('?view=front')).page;
    await holdStill(first);
    await first.bringToFront();
    await grabTool(first);
    const holder = await first.evaluate(() => window.haptolith!.client);
    await second.waitForFunction((client) => window.haptolith!.status!.held_by === client, holder);
    await second.bringToFront();
    await second.keyboard.press('PageUp');
    await second.locator('.toast').first().waitFor({ state: 'visible' });
    expect(await second.evaluate(() => window.haptolith!.status!.held_by)).toBe(holder);
    await first.bringToFront();
    await first.mouse.up();
    await second.waitForFunction(() => window.haptolith!.status!.held_by === null);
  });

  it('comes back by itself when the program has been started again', async () => {
    const { page, complaints } = await visit();
    const port = portOf(program);
    await program.stop();
    await page.locator('.banner').waitFor({ state: 'visible' });
    expect(await page.locator('.banner').textContent()).toContain('retrying');
    program = await startProgram(port);
    await page.locator('.banner').waitFor({ state: 'hidden' });
    const { number } = await frame(page);
    await page.waitForFunction((before) => window.haptolith!.frame!.number !== before, number);
    expect(complaints).toEqual([]);
  });
});

describe('in a headset', () => {
  const iwer = readFileSync(createRequire(import.meta.url).resolve('iwer/build/iwer.min.js'), 'utf8');
  const HEADSET = {
    content: `${iwer};
      const device = new IWER.XRDevice(IWER.metaQuest3);
      // Debian's Chromium has WebXR, but no headset to go with it.
      device.installRuntime({ forceInstall: true });
      device.position.set(0, 1.6, 0.2);
      window.emulated = device;`,
  };

  it('the controller is the shovel', async () => {
    const { page, complaints } = await visit('', HEADSET);
    await holdStill(page);
    await page.getByRole('button', { name: 'Enter VR' }).click();
    await page.waitForFunction(() => window.haptolith!.inHeadset);
    const drawn = await page.evaluate(() => window.haptolith!.framesDrawn);
    await page.waitForFunction((before) => window.haptolith!.framesDrawn > before + 3, drawn);

    const before = await frame(page);
    type Emulated = { controllers: { right: { position: { set(x: number, y: number, z: number): void }; updateButtonValue(id: string, value: number): void } } }; // prettier-ignore
    await page.evaluate(() => {
      const { right } = (window as unknown as { emulated: Emulated }).emulated.controllers;
      right.position.set(0.1, 1.2, -0.4);
      right.updateButtonValue('trigger', 1);
    });
    await page.waitForFunction(() => window.haptolith!.frame!.held);
    await page.evaluate(() =>
      (window as unknown as { emulated: Emulated }).emulated.controllers.right.position.set(0.1, 1.26, -0.4),
    );
    await page.waitForFunction(
      (z) => window.haptolith!.frame!.tool.position_m[2] > z + 0.008,
      before.tool.position_m[2],
    );
    await page.evaluate(() =>
      (window as unknown as { emulated: Emulated }).emulated.controllers.right.updateButtonValue('trigger', 0),
    );
    await page.waitForFunction(() => !window.haptolith!.frame!.held);

    await page.keyboard.press('v');
    await page.waitForFunction(() => !window.haptolith!.inHeadset);
    expect(complaints).toEqual([]);
  });
});
