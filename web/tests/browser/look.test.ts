// What a stranger sees of the page: on other screens, without a graphics card, by keyboard and by screen reader.

import { chromium, type Browser } from 'playwright-core';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { MockServer, type MockOptions } from '../mock-server';
import { executable, launch, newPage, type Watched } from './pages';

let browser: Browser;
const open: Watched[] = [];
const servers: MockServer[] = [];

async function visit(options: MockOptions = {}, query = '', by = browser): Promise<Watched> {
  const server = new MockServer(options);
  servers.push(server);
  const watched = await newPage(by);
  open.push(watched);
  await watched.page.goto(`http://127.0.0.1:${await server.listen()}/${query}`);
  await watched.page.waitForFunction(() => window.haptolith?.frame && window.haptolith.status);
  return watched;
}

beforeAll(async () => {
  browser = await launch();
});

afterEach(async () => {
  for (const { page } of open.splice(0)) await page.close();
  for (const server of servers.splice(0)) await server.close();
});

afterAll(async () => {
  await browser?.close();
});

describe('without WebGL 2', () => {
  let blind: Browser;

  beforeAll(async () => {
    blind = await chromium.launch({ executablePath: executable(), args: ['--no-sandbox', '--disable-3d-apis'] });
  });

  afterAll(async () => {
    await blind?.close();
  });

  it('says so where the picture would be, and numbers, plots and controls work', async () => {
    const { page } = await visit({}, '', blind);
    await page.getByText('this browser shows no WebGL 2').waitFor();
    await page.getByLabel('Body').selectOption('Mars');
    await page.waitForFunction(() => window.haptolith!.scene!.body === 'Mars');
    await page.waitForFunction(() => /\d/.test(document.querySelector('[data-test=force]')!.textContent!));
    expect(await page.locator('.uplot canvas').count()).toBe(3);
    const height_m = () => page.evaluate(() => window.haptolith!.frame!.tool.position_m[2]);
    const before_m = await height_m();
    await page.keyboard.down('PageUp');
    await expect.poll(height_m, { timeout: 15_000 }).toBeGreaterThan(before_m + 0.004);
    await page.keyboard.up('PageUp');
    expect(await page.evaluate(() => window.haptolith!.ready)).toBe(false);
  });
});

describe('a recording', () => {
  it('is named in full with its folder when it stops, and can be downloaded with the token', async () => {
    const { page } = await visit({ token: 'a_long_secret_token' }, '?token=a_long_secret_token');
    await page.getByRole('button', { name: 'Record' }).click();
    await page.getByText('recording haptolith-20260101-120000.h5').waitFor();
    await page.getByRole('button', { name: 'Stop' }).click();
    await page.getByText('haptolith-20260101-120000.h5 is in /home/ada/experiments').waitFor();
    const downloading = page.waitForEvent('download');
    await page.getByRole('link', { name: 'Download' }).click();
    const download = await downloading;
    expect(download.suggestedFilename()).toBe('haptolith-20260101-120000.h5');
    expect(await download.failure()).toBeNull();
  });
});

describe('on a screen', () => {
  const SIZES = [
    [640, 360],
    [844, 390],
    [390, 844],
    [1280, 720],
  ] as const;

  it.each(SIZES)('of %i x %i the soil and the tool are to be seen', async (width, height) => {
    const { page } = await visit();
    await page.setViewportSize({ width, height });
    const view = (await page.locator('.view').boundingBox())!;
    expect(view.height).toBeGreaterThan(0.5 * height);
    expect(view.width).toBeGreaterThan(0.5 * width);
    // What lies over the picture hides neither the middle of the bed nor the tool where it starts.
    const places = await page.evaluate(() => [window.haptolith!.toolOnScreen!, window.haptolith!.bedOnScreen!]);
    for (const name of ['.readouts', '.hint', '.legend', '.scale-bar']) {
      const box = (await page.locator(name).boundingBox()) ?? { x: 0, y: 0, width: 0, height: 0 };
      for (const { x, y } of places) {
        const inside = x > box.x && x < box.x + box.width && y > box.y && y < box.y + box.height;
        expect({ name, inside }).toEqual({ name, inside: false });
      }
    }
    for (const { x, y } of places) {
      expect(x).toBeGreaterThan(view.x);
      expect(x).toBeLessThan(view.x + view.width);
      expect(y).toBeGreaterThan(view.y);
      expect(y).toBeLessThan(view.y + view.height);
    }
  });
});
