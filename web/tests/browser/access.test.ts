// Permissions of a page: tokens, read-only pages, and a person at a device.

import type { Vec3 } from 'haptolith-protocol';
import type { Browser } from 'playwright-core';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { MockServer, type MockOptions } from '../mock-server';
import { MockStudy } from '../mock-study';
import { launch, newPage, pixelsIn, scene, type Watched } from './pages';

let browser: Browser;
const open: Watched[] = [];
const servers: MockServer[] = [];

async function visit(options: MockOptions, query = ''): Promise<Watched> {
  const server = new MockServer(options);
  servers.push(server);
  const watched = await newPage(browser);
  open.push(watched);
  await watched.page.goto(`http://127.0.0.1:${await server.listen()}/${query}`);
  return watched;
}

const connected = ({ page }: Watched) => page.waitForFunction(() => window.haptolith?.client != null);

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

describe('access', () => {
  it('takes the token out of the address, and finds the program again when the page is loaded again', async () => {
    const watched = await visit({ token: 'a_long_secret_token' }, '?token=a_long_secret_token&view=top');
    await connected(watched);
    expect(watched.page.url()).toMatch(/\/\?view=top$/);
    await watched.page.reload();
    await connected(watched);
    expect(watched.complaints).toEqual([]);
  });

  it.each(['', '?study=participant', '?study=experimenter'])(
    'says what is missing without a token: %s',
    async (query) => {
      const { page } = await visit({ token: 'a_long_secret_token', study: new MockStudy() }, query);
      await page.getByText('access token missing').waitFor();
      const view = (await page.locator('.view').boundingBox())!;
      const button = (await page.getByRole('button', { name: 'Try now' }).boundingBox())!;
      expect(button.x).toBeGreaterThan(view.x);
      expect(button.x + button.width).toBeLessThan(view.x + view.width);
    },
  );

  it('lets who may only look on change nothing, and says why', async () => {
    const watched = await visit({ read_only: true });
    await connected(watched);
    const { page } = watched;
    await page.getByText('the program was started with --read-only').waitFor();
    for (const name of ['soil', 'body', 'motion', 'speed'])
      expect(await page.locator(`#${name}`).isDisabled()).toBe(true);
    for (const name of ['Reset', 'Level', 'Pause', 'Record'])
      expect(await page.getByRole('button', { name, exact: true }).isDisabled()).toBe(true);
    expect(await page.getByRole('button', { name: 'speed' }).isDisabled()).toBe(false); // a colour
    await page.keyboard.press('PageUp');
    await page.waitForTimeout(200);
    expect(await page.evaluate(() => window.haptolith!.frame!.held)).toBe(false);
    expect(await page.locator('.toast').count()).toBe(0);
  });

  it('shows a robot that follows the tool, where it was heard to be', async () => {
    const robot = {
      state: 'following',
      reason: null,
      heard: true,
      behind: 2600,
      round_trip_s: 2.6,
      pose: [0.03, 0.02, 0.12, 1, 0, 0, 0],
      felt_n: [-2, 0, 1] as Vec3,
      met_n: [-3, 0, 4] as Vec3,
      learned: {
        friction_angle_deg: [31.2, 34.4, 37.1],
        cohesion_pa: [90, 150, 240],
        tool_friction_angle_deg: [15, 18, 21],
      },
      site: {
        corner_m: [-0.04, -0.04] as [number, number],
        cell_m: 0.01,
        columns: 8,
        rows: 8,
        heights_mm: Array.from({ length: 64 }, (_, i) => (i === 9 ? null : i % 8)),
      },
    };
    const watched = await visit({ robot });
    await connected(watched);
    const { page } = watched;
    await page.getByText('following, 2.6 s behind').waitFor();
    await page.getByText('estimated soil: 34° (31 to 37), 150 Pa (90 to 240)').waitFor();
    expect((await page.locator('[data-test=met]').textContent())?.trim()).toBe('5.00');
    expect(await page.locator('[data-test=met]').isVisible()).toBe(true);
    const site = page.getByRole('region', { name: "The robot's site" });
    expect(await site.textContent()).toBe("robot's site, 2.6 s ago");
    const picture = await pixelsIn(page, (await site.locator('.site-window').boundingBox())!);
    const reds = new Set(picture.filter((_, i) => i % 4 === 0));
    expect(reds.size, 'soil in light and shadow').toBeGreaterThan(20);
    expect(watched.complaints).toEqual([]);
  });

  it('shows no robot where none follows', async () => {
    const watched = await visit({});
    await connected(watched);
    expect(await watched.page.locator('[data-test=met]').isVisible()).toBe(false);
    expect(await watched.page.getByRole('group', { name: 'robot', exact: true }).count()).toBe(0);
    expect(await watched.page.locator('.site-card').isVisible()).toBe(false);
  });

  it('asks before it changes what a person feels, once', async () => {
    const watched = await visit({ person_feels: true });
    await connected(watched);
    const { page } = watched;
    await page.waitForFunction(() => window.haptolith!.status?.person_feels);
    const body = page.locator('#body');
    await body.selectOption('Mars');
    await page.getByRole('button', { name: 'Cancel' }).click();
    await page.waitForFunction((select) => (select as HTMLSelectElement).value === 'Moon', await body.elementHandle());
    expect((await scene(page)).body).toBe('Moon');
    await body.selectOption('Mars');
    await page.getByRole('heading', { name: 'A user is holding the device' }).waitFor();
    await page.getByRole('button', { name: 'Change' }).click();
    await page.waitForFunction(() => window.haptolith!.scene!.body === 'Mars');
    await page.locator('#body').selectOption('Earth');
    await page.waitForFunction(() => window.haptolith!.scene!.body === 'Earth');
    expect(await page.locator('dialog[open]').count()).toBe(0);
    expect(watched.complaints).toEqual([]);
  });
});
