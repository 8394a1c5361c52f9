// Accessibility of every page in each of its lasting states: axe, on a wide screen and as on a phone in landscape.

import type { Browser, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { MockServer, type MockOptions } from '../mock-server';
import { MockStudy } from '../mock-study';
import { launch, launchWithoutWebGl, newPage, violations } from './pages';

const LOOKS = [
  { width: 1280, height: 720, theme: 'dark' },
  { width: 1280, height: 720, theme: 'light' },
  { width: 844, height: 390, theme: 'dark' },
] as const;

let browser: Browser;
const open: Page[] = [];
const servers: MockServer[] = [];

async function visit(options: MockOptions, query = '', by = browser): Promise<Page> {
  const server = new MockServer(options);
  servers.push(server);
  const { page } = await newPage(by);
  open.push(page);
  page.setDefaultTimeout(90_000); // axe and a picture drawn in software at once
  await page.goto(`http://127.0.0.1:${await server.listen()}/${query}`);
  return page;
}

const connected = (page: Page) => page.waitForFunction(() => window.haptolith?.client != null);

/** Checks the page in its current state. */
async function check(page: Page, state: string): Promise<void> {
  for (const { width, height, theme } of LOOKS) {
    await page.setViewportSize({ width, height });
    await page.evaluate((name) => window.haptolith!.setTheme(name), theme);
    await page.waitForTimeout(200); // colours fade
    if (process.env.SHOTS) await page.screenshot({ path: `${process.env.SHOTS}/${state}-${width}-${theme}.png` });
    expect.soft({ state, width, theme, found: await violations(page) }).toEqual({ state, width, theme, found: [] });
  }
}

beforeAll(async () => {
  browser = await launch();
});

afterEach(async () => {
  for (const page of open.splice(0)) await page.close();
  for (const server of servers.splice(0)) await server.close();
});

afterAll(async () => {
  await browser?.close();
});

describe('nobody is kept out', { timeout: 900_000 }, () => {
  it('of the page, its help, what it has to say, and when the program has gone', async () => {
    const page = await visit({});
    await page.waitForFunction(() => window.haptolith?.ready === true);
    await page.keyboard.press('?');
    await page.getByRole('dialog').waitFor();
    await check(page, 'help');
    await page.keyboard.press('Escape');
    await page.setViewportSize({ width: 1280, height: 720 });
    await page.getByRole('button', { name: 'cylinder' }).click();
    await page.getByLabel('length in mm').waitFor();
    await page.getByRole('button', { name: 'Record' }).click();
    await page.getByRole('button', { name: 'Stop' }).click();
    await page.getByRole('link', { name: 'Download' }).waitFor();
    await page.getByRole('button', { name: 'Pause' }).click();
    await page.getByRole('button', { name: 'Resume' }).waitFor();
    await page.evaluate(() => window.haptolith!.setColour('force'));
    await check(page, 'paused-cylinder');
    await page.keyboard.press('u');
    await page.locator('.toast').waitFor();
    await check(page, 'refused');
    await servers.pop()!.close();
    await page.locator('.banner').waitFor();
    await check(page, 'gone');
  });

  it('of the page that may only be looked at', async () => {
    const page = await visit({ read_only: true });
    await connected(page);
    await check(page, 'read-only');
  });

  it('of the page beside a robot that has stopped', async () => {
    const page = await visit({
      robot: {
        state: 'holding',
        reason: 'too much force',
        heard: true,
        behind: 2650,
        round_trip_s: 2.6,
        pose: [0.03, 0.02, 0.05, 1, 0, 0, 0],
        felt_n: [0, 0, 1],
        met_n: [0, 0, 90],
        site: { corner_m: [-0.02, -0.02], cell_m: 0.02, columns: 2, rows: 2, heights_mm: [0, 1, 2, 3] },
      },
    });
    await page.getByText('holding (too much force)').waitFor();
    await check(page, 'robot');
  });

  it('of the page that asks before it changes what a person feels', async () => {
    const page = await visit({ person_feels: true });
    await page.waitForFunction(() => window.haptolith?.status?.person_feels);
    await page.locator('#body').selectOption('Mars');
    await page.getByRole('heading', { name: 'A user is holding the device' }).waitFor();
    await check(page, 'asks-first');
  });

  it('of the page that lacks the token', async () => {
    const page = await visit({ token: 'a_long_secret_token' });
    await page.getByText('access token missing').waitFor();
    await check(page, 'no-token');
  });

  it('without WebGL 2', async () => {
    const blind = await launchWithoutWebGl();
    try {
      const page = await visit({}, '', blind);
      await page.getByText('this browser shows no WebGL 2').waitFor();
      await check(page, 'no-webgl');
    } finally {
      open.splice(0);
      await blind.close();
    }
  });

  it("of the participant's page in all its phases", async () => {
    const study = new MockStudy({ interval_s: 600, preparing_s: 600, feedback_s: 600, break_s: 600 });
    const page = await visit({ study }, '?study=participant');
    await connected(page);
    const shows = async (phase: string, times = 1): Promise<void> => {
      if (study.phase !== phase || times > 1) study.skipTo(phase as Parameters<MockStudy['skipTo']>[0], times);
      await page.waitForSelector(`.participant[data-phase="${phase}"]`);
    };
    for (const phase of ['consent', 'form', 'instructions', 'preparing', 'interval', 'question', 'feedback'] as const) {
      await shows(phase);
      await check(page, `participant-${phase}`);
    }
    await shows('form');
    await page.getByRole('button', { name: 'Continue' }).click();
    await page.getByText('Please answer this question.').first().waitFor();
    await check(page, 'participant-form-faults');
    await shows('break');
    await check(page, 'participant-break');

    await page.getByRole('button', { name: 'Stop taking part' }).click();
    await page.getByRole('heading', { name: 'Do you want to stop taking part?' }).waitFor();
    await check(page, 'participant-stop');
    await page.getByRole('button', { name: 'No, continue' }).click();
    study.obey(99, { do: 'study', act: 'join', as: 'experimenter' });
    study.obey(99, { do: 'study', act: 'pause' });
    await shows('paused');
    await check(page, 'participant-paused');
    study.obey(99, { do: 'study', act: 'resume' });
    await shows('finished');
    await check(page, 'participant-finished');
    study.obey(98, { do: 'study', act: 'join', as: 'participant' });
    study.obey(98, { do: 'study', act: 'quit' });
    await shows('withdrawn');
    await check(page, 'participant-withdrawn');
    await servers.pop()!.close();
    await page.getByText('Connection lost').waitFor();
    await check(page, 'participant-gone');
  });

  it("of the participant's page by feel alone, and while there is no study", async () => {
    const study = new MockStudy({ interval_s: 600, visual: false });
    study.skipTo('interval');
    const feels = await visit({ study }, '?study=participant');
    await feels.waitForSelector('.participant[data-phase="interval"]');
    await check(feels, 'participant-by-feel');
    const waits = await visit({}, '?study=participant');
    await waits.locator('main').getByText('No study is running.', { exact: true }).waitFor();
    await check(waits, 'participant-waiting');
  });

  it("of the experimenter's page, blinded and not, and in its dialogs", async () => {
    const study = new MockStudy({ interval_s: 600, preparing_s: 600, feedback_s: 600, break_s: 600 });
    study.skipTo('question', 12);
    const page = await visit({ study }, '?study=experimenter');
    await page.getByText('S01').waitFor();
    await page.locator('tbody tr').first().waitFor();
    await check(page, 'experimenter-blinded');
    for (const [name, state] of [
      ['Repeat a trial…', 'repeat'],
      ['End for today…', 'end'],
      ['Unblind…', 'unblind'],
    ] as const) {
      await page.setViewportSize({ width: 1280, height: 720 });
      await page.getByRole('button', { name }).click();
      await page.getByRole('dialog').waitFor();
      await check(page, `experimenter-${state}`);
      if (state !== 'unblind') await page.keyboard.press('Escape');
    }
    await page.getByRole('button', { name: 'Unblind', exact: true }).click();
    await page.getByRole('button', { name: 'Blind again' }).waitFor();
    study.problem = 'The device does not answer.';
    await page.getByRole('alert').getByText('The device does not answer.').waitFor();
    await page.keyboard.press('p');
    await page.getByRole('button', { name: 'Resume' }).waitFor();
    await check(page, 'experimenter-paused');
    await servers.pop()!.close();
    await page.locator('.banner').waitFor();
    await check(page, 'experimenter-gone');
  });
});
