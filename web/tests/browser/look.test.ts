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
