// The page for different users: on other screens, without a graphics card, by keyboard and by screen reader.

import type { Browser } from 'playwright-core';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { MockServer, type MockOptions } from '../mock-server';
import { SCOOP } from '../scoop';
import { launch, launchWithoutWebGl, newPage, pixelsIn, violations, type Watched } from './pages';

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
    blind = await launchWithoutWebGl();
  });

  afterAll(async () => {
    await blind?.close();
  });

  it('says so where the picture would be, and numbers, plots and controls work', async () => {
    const { page } = await visit({}, '', blind);
    await page.getByText('this browser shows no WebGL 2').waitFor();
    await page.locator('#body').selectOption('Mars');
    await page.waitForFunction(() => window.haptolith!.scene!.body === 'Mars');
    await page.waitForFunction(() => /\d/.test(document.querySelector('[data-test=force]')!.textContent!));
    expect(await page.locator('.uplot canvas').count()).toBe(3);
    const height_m = () => page.evaluate(() => window.haptolith!.frame!.tool.position_m[2]);
    const before_m = await height_m();
    await page.keyboard.down('PageUp');
    await expect.poll(height_m, { timeout: 150_000 }).toBeGreaterThan(before_m + 0.004);
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

describe('a tool that somebody drew', () => {
  const shape = (page: Watched['page']) => page.evaluate(() => window.haptolith!.scene!.tool.shape);

  it('is one of the tools, by its button and by the key', async () => {
    const { page, complaints } = await visit({ mesh: SCOOP });
    const button = page.getByRole('button', { name: 'mesh', exact: true });
    expect(await button.getAttribute('title')).toBe('scoop.stl');
    await button.click();
    await page.locator('[data-shape=mesh][aria-pressed=true]').waitFor();
    expect(await page.locator('.size').count()).toBe(0);
    const drawn = await page.evaluate(() => window.haptolith!.framesDrawn);
    await page.waitForFunction((before) => window.haptolith!.framesDrawn > before + 2, drawn);
    await button.blur();
    await page.keyboard.press('x');
    await expect.poll(() => shape(page)).toBe('box');
    expect(complaints).toEqual([]);
  });

  it('is none of them where nobody drew any', async () => {
    const { page } = await visit();
    expect(await page.getByRole('button', { name: 'jaws' }).isVisible()).toBe(true);
    expect(await page.locator('[data-shape=mesh]').isVisible()).toBe(false);
    await page.getByRole('button', { name: 'jaws' }).click();
    await page.locator('[data-shape=jaws][aria-pressed=true]').waitFor();
    await page.keyboard.press('x');
    await expect.poll(() => shape(page)).toBe('box');
  });
});

describe('stones', () => {
  it('are drawn, and put into words', async () => {
    const { name: _, ...text } = SCOOP;
    const spheres: [number, number, number, number][] = [[0, 0, 0, 0.01], [0.01, 0, 0, 0.01]]; // prettier-ignore
    const { page, complaints } = await visit({
      stones: [
        { text, pose: { position_m: [0.03, 0.02, 0.05], rotation: [1, 0, 0, 0] } },
        { text: { spheres }, pose: { position_m: [-0.03, -0.02, 0.1], rotation: [1, 0, 0, 0] } },
      ],
    });
    await page.waitForFunction(() => window.haptolith!.ready);
    const label = page.locator('canvas[role=img]');
    await expect.poll(() => label.getAttribute('aria-label')).toContain('particles and 2 stones');
    expect(complaints).toEqual([]);
  });
});

describe('soil', () => {
  /** Returns the mean brightness of patches of the picture, 0 to 255. */
  async function patches(page: Watched['page'], places: { x: number; y: number }[]): Promise<number[]> {
    const means: number[] = [];
    for (const { x, y } of places) {
      const data = await pixelsIn(page, { x: Math.round(x) - 20, y: Math.round(y) - 10, width: 40, height: 20 });
      means.push(data.reduce((sum, value, i) => sum + (i % 4 === 3 ? 0 : value), 0) / ((3 * data.length) / 4));
    }
    return means;
  }

  it('lies in the ground, as bright as that, or is balls in a box that stands on it', async () => {
    const { page, complaints } = await visit({}, '?panels=0');
    await page.waitForFunction(() => window.haptolith!.ready);
    const redrawn = async (): Promise<void> => {
      const drawn = await page.evaluate(() => window.haptolith!.framesDrawn);
      await page.evaluate(() => window.haptolith!.setCamera('three-quarter'));
      await page.waitForFunction((before) => window.haptolith!.framesDrawn > before, drawn);
    };
    const middle = (await page.evaluate(() => window.haptolith!.bedOnScreen))!;
    const in_front = { x: middle.x, y: (await page.locator('.view').boundingBox())!.height - 40 };
    await redrawn();
    const [bed, ground] = await patches(page, [middle, in_front]);
    expect(bed! / ground!).toBeGreaterThan(0.7);
    expect(bed! / ground!).toBeLessThan(1.4);
    await page.keyboard.press('p');
    await redrawn();
    const [balls, floor] = await patches(page, [(await page.evaluate(() => window.haptolith!.bedOnScreen))!, in_front]);
    expect(Math.abs(balls! - bed!) + Math.abs(floor! - ground!)).toBeGreaterThan(8);
    expect(await page.locator('[data-drawing=balls]').getAttribute('aria-pressed')).toBe('true');
    await page.reload();
    await page.waitForFunction(() => window.haptolith?.ready === true);
    expect(await page.locator('[data-drawing=balls]').getAttribute('aria-pressed')).toBe('true');
    expect(complaints).toEqual([]);
  });
});

describe('on a screen', () => {
  const SIZES = [
    [640, 360],
    [844, 390],
    [390, 844],
    [800, 600],
    [1280, 720],
  ] as const;

  it.each(SIZES)('of %i x %i the soil and the tool are to be seen', async (width, height) => {
    const { page } = await visit();
    await page.setViewportSize({ width, height });
    await page.waitForTimeout(500); // the picture is fitted again
    const view = (await page.locator('.view').boundingBox())!;
    expect(view.height).toBeGreaterThan(0.5 * height);
    expect(view.width).toBeGreaterThan(0.5 * width);
    // Panels over the picture hide neither the centre of the bed nor the tool's initial position.
    const places = await page.evaluate(() => [window.haptolith!.toolOnScreen!, window.haptolith!.bedOnScreen!]);
    for (const name of ['.readouts', '.hint', '.legend', '.scale-bar', '.tilt']) {
      const box = (await page.locator(name).boundingBox()) ?? { x: 0, y: 0, width: 0, height: 0 };
      for (const { x, y } of places) {
        const inside = x > box.x && x < box.x + box.width && y > box.y && y < box.y + box.height;
        expect({ name, inside }).toEqual({ name, inside: false });
      }
    }
    const hint = await page.locator('.hint').boundingBox();
    for (const name of ['.legend', '.scale-bar', '.readouts', '.tilt']) {
      const box = await page.locator(name).boundingBox();
      if (!hint || !box) continue; // not shown
      const apart =
        hint.x + hint.width <= box.x ||
        box.x + box.width <= hint.x ||
        hint.y + hint.height <= box.y ||
        box.y + box.height <= hint.y;
      expect({ name, apart }).toEqual({ name, apart: true });
    }
    for (const { x, y } of places) {
      expect(x).toBeGreaterThan(view.x);
      expect(x).toBeLessThan(view.x + view.width);
      expect(y).toBeGreaterThan(view.y);
      expect(y).toBeLessThan(view.y + view.height);
    }
  });
});

describe('for everybody', () => {
  for (const [width, height] of [
    [1280, 720],
    [390, 844],
    [844, 390],
  ] as const)
    // prettier-ignore
    for (const theme of ['dark', 'light'])
      it(`has nothing that keeps somebody out, at ${width} x ${height}, ${theme}`, async () => {
        const watched = await visit({}, `?theme=${theme}`);
        await watched.page.setViewportSize({ width, height });
        await watched.page.waitForTimeout(300);
        expect(await violations(watched.page)).toEqual([]);
        if (width === 1280) return;
        await watched.page.getByRole('button', { name: 'Controls' }).click();
        expect(await violations(watched.page)).toEqual([]);
      });

  it('explains every number and every selector, by keyboard too', async () => {
    const watched = await visit();
    const { page } = watched;
    const unexplained = await page.evaluate(() =>
      [
        ...document.querySelectorAll<HTMLElement>(
          '.cell, .readout-name, .controls select, .controls button, .controls input',
        ),
      ]
        .filter((element) => !element.matches('.sizes *, .segmented [data-shape]'))
        .filter((element) => {
          const source = document.getElementById(element.getAttribute('aria-describedby') ?? '');
          return !source?.textContent || element.tabIndex < 0;
        })
        .map((element) => element.outerHTML.slice(0, 120)),
    );
    expect(unexplained).toEqual([]);
    const bubble = page.getByRole('tooltip');
    for (let i = 0; i < 2; ++i) await page.keyboard.press('Tab'); // pace of the loop, time
    await bubble.getByText('Simulated time since the program started').waitFor();
    expect(await violations(page)).toEqual([]);
    await page.keyboard.press('Escape');
    await bubble.waitFor({ state: 'hidden' });
    await page.locator('.pace').click();
    expect(await violations(page)).toEqual([]);
    await page.getByRole('group', { name: 'tick p99' }).hover();
    await bubble.getByText('99 % of ticks').waitFor();
    await page.keyboard.press('Escape');
    await page.locator('.pace-details').waitFor({ state: 'hidden' });
    await page.mouse.move(600, 300);
    await bubble.waitFor({ state: 'hidden' });
    await page.getByLabel('Friction model').hover();
    await bubble.getByText('Model of friction between particles').waitFor();
  });

  it('writes nothing smaller than 12 pixels', async () => {
    const { page } = await visit();
    const small = await page.evaluate(() =>
      [...document.querySelectorAll<HTMLElement>('body *')]
        .filter((element) => [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent!.trim()))
        .filter((element) => parseFloat(getComputedStyle(element).fontSize) < 12)
        .map((element) => element.outerHTML.slice(0, 120)),
    );
    expect(small).toEqual([]);
  });

  it('says in words what the pictures show', async () => {
    const { page } = await visit();
    await page.getByRole('img', { name: /particles; shovel \d+ mm above the soil/ }).waitFor();
    await page.getByRole('img', { name: /^Force in N over the last ten seconds\. x / }).waitFor();
    expect(await page.locator('canvas:not([role=img], [role=img] canvas)').count()).toBe(0);
  });
});

describe('what is shown', () => {
  it('of a program that has gone is no number of before', async () => {
    const { page } = await visit();
    await page.waitForFunction(() => /Hz/.test(document.querySelector('.cells')!.textContent!));
    await servers.pop()!.close();
    await page.locator('.banner').waitFor({ state: 'visible' });
    const cells = page.locator('.cells');
    expect(await cells.textContent()).not.toMatch(/Hz|µs|%/);
    expect(await page.locator('.pace').textContent()).toBe('–');
  });

  it('in slow motion is no warning', async () => {
    const { page } = await visit();
    await page.keyboard.press('n');
    await page.waitForFunction(() => window.haptolith!.status!.speed < 1);
    const pace = page.getByRole('button', { name: 'slow motion' });
    await pace.waitFor();
    expect(await pace.getAttribute('data-level')).toBe('none');
  });

  it('of a loop that is late is one word, the causes at a click, and coarser soil', async () => {
    const { page } = await visit({ late: 'soil' });
    await page.getByRole('button', { name: 'late: coarser soil?' }).click();
    await page.getByText('The particles are too small for this machine').waitFor();
    await page.getByRole('group', { name: 'missed, last 10 s' }).getByText('too long').waitFor();
    await page.getByRole('button', { name: 'Coarser soil', exact: true }).click();
    await page.getByRole('button', { name: 'Coarser soil', exact: true }).waitFor({ state: 'hidden' });
    await page.waitForFunction(() => window.haptolith!.scene!.radius_m > 0.007);
  });

  it('of a loop that other programs keep waiting says so', async () => {
    const { page } = await visit({ late: 'others' });
    await page.getByRole('button', { name: 'late: other programs' }).click();
    await page.getByText('Other programs delay the force loop').waitFor();
  });

  it.each([
    [1280, 720],
    [390, 844],
  ] as const)('in the strip and the help is not cut off at %i x %i', async (width, height) => {
    // prettier-ignore
    const { page } = await visit({ late: 'soil' });
    await page.setViewportSize({ width, height });
    await page.getByRole('button', { name: 'late: coarser soil?' }).waitFor();
    const cut = await page.evaluate(
      () =>
        [...document.querySelectorAll<HTMLElement>('.cells > :not(.pace-details)')]
          .map((cell) => cell.getBoundingClientRect())
          .filter(({ right, width }) => width > 0 && right > innerWidth).length,
    );
    expect(cut).toBe(0);
    await page.getByRole('button', { name: 'Help' }).click();
    const licences = (await page.getByRole('link', { name: 'Licences' }).boundingBox())!;
    expect(licences.y + licences.height).toBeLessThan(height);
  });

  it('of the tilt is its angle, which a slider and buttons set', async () => {
    const { page } = await visit();
    const slider = page.getByLabel('Tilt of the tool in degrees, nose down');
    await slider.fill('0');
    await page.waitForFunction(() => Math.abs(window.haptolith!.frame!.tool.rotation[2]) < 0.05);
    await page.getByRole('button', { name: 'Nose down (W)' }).click();
    await page.locator('.tilt output').getByText('10°').waitFor();
    await page.waitForFunction(() => !window.haptolith!.frame!.held);
  });

  it('of the friction model is its name, and a warning where soil does not fall as it should', async () => {
    const { page } = await visit();
    const model = page.getByLabel('Friction model');
    expect(await model.locator('option').allInnerTexts()).toEqual(['ICRA 2021 (drag against space)', 'contact']);
    const warning = page.getByText('This model acts against absolute space');
    await warning.waitFor();
    await model.selectOption({ label: 'contact' });
    await warning.waitFor({ state: 'hidden' });
  });

  it('of a tool that is out of the picture comes back at the press of a button', async () => {
    const { page } = await visit();
    await page.keyboard.down('ArrowRight');
    await expect
      .poll(() => page.evaluate(() => window.haptolith!.frame!.tool.position_m[0]), { timeout: 150_000 })
      .toBeGreaterThan(0.06);
    await page.keyboard.up('ArrowRight');
    await page.waitForFunction(() => !window.haptolith!.frame!.held);
    await page.mouse.move(400, 300);
    for (let i = 0; i < 20; ++i) await page.mouse.wheel(0, -200); // so near that the tool is outside the picture
    await page.getByRole('button', { name: 'Bring tool here' }).click();
    await expect
      .poll(() => page.evaluate(() => Math.hypot(...window.haptolith!.frame!.tool.position_m.slice(0, 2))), {
        timeout: 150_000,
      })
      .toBeLessThan(0.003);
    const view = (await page.locator('.view').boundingBox())!;
    const at = await page.evaluate(() => window.haptolith!.toolOnScreen!);
    expect(at.x).toBeGreaterThan(view.x);
    expect(at.x).toBeLessThan(view.x + view.width);
    expect(at.y).toBeGreaterThan(view.y);
    expect(at.y).toBeLessThan(view.y + view.height);
  });
});
