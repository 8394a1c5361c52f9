// Both pages of a study with the mock, whose state a test can inspect and advance.

import type { Browser, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { MockServer } from '../mock-server';
import { ENDED, MockStudy, type MockStudyOptions } from '../mock-study';
import { launch, newPage, toolOnScreen, type Watched } from './pages';

let browser: Browser;
const open: Watched[] = [];
const servers: MockServer[] = [];

// Long enough that nothing advances automatically during a check.
const SLOW: MockStudyOptions = { interval_s: 60, preparing_s: 0.05, feedback_s: 60, break_s: 60 };

async function serve(study: MockStudy, port = 0): Promise<string> {
  const server = new MockServer({ study, port });
  servers.push(server);
  return `http://127.0.0.1:${await server.listen()}/`;
}

async function visit(address: string, who: 'participant' | 'experimenter'): Promise<Watched> {
  const watched = await newPage(browser);
  open.push(watched);
  await watched.page.goto(`${address}?study=${who}`);
  await watched.page.waitForFunction(() => window.haptolith !== undefined && window.haptolith.client !== null);
  return watched;
}

/** Opens the page of a participant at the first screen of a phase. */
async function participantAt(phase: Parameters<MockStudy['skipTo']>[0], times = 1, options = {}) {
  const study = new MockStudy({ ...SLOW, ...options });
  study.skipTo(phase, times);
  const address = await serve(study);
  const watched = await visit(address, 'participant');
  await shows(watched.page, phase);
  return { ...watched, study, address };
}

const shows = (page: Page, phase: string) => page.waitForSelector(`.participant[data-phase="${phase}"]`);

/** Waits until acts on the current screen count. */
const settle = (page: Page) => page.waitForTimeout(300);

/** Lowers the tool by key until it has a contact force. */
async function touchSoil(page: Page): Promise<void> {
  await page.keyboard.down('PageDown');
  await page.locator('.go:enabled').waitFor();
  await page.keyboard.up('PageDown');
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

describe("the participant's page", () => {
  it('leads through a trial by keyboard alone', async () => {
    const study = new MockStudy(SLOW);
    const { page, complaints } = await visit(await serve(study), 'participant');
    await shows(page, 'consent');
    await settle(page);
    await page.keyboard.press('Enter');
    await shows(page, 'form');
    await settle(page);
    await page.keyboard.type('31');
    await page.keyboard.press('Tab');
    await page.keyboard.press('ArrowRight'); // right hand
    await page.keyboard.press('Tab');
    await page.keyboard.press('Space'); // yes
    await page.keyboard.press('Tab');
    await page.keyboard.press('Tab');
    await page.keyboard.type('geology');
    await page.keyboard.press('Enter');
    await shows(page, 'instructions');
    expect(study.filled).toEqual([{ age: '31', hand: 'right', device: 'yes', job: 'geology' }]);
    await settle(page);
    await page.keyboard.press('Enter');
    for (const label of ['First', 'Second']) {
      await page.getByRole('heading', { name: label }).waitFor();
      await settle(page);
      await touchSoil(page);
      await page.keyboard.press('Enter');
    }
    await shows(page, 'question');
    await settle(page);
    await page.keyboard.press('2');
    await shows(page, 'feedback');
    expect(await page.locator('h1').innerText()).toBe('Correct');
    expect(study.given).toHaveLength(1);
    expect(study.given[0]!.positive).toBe(true);
    expect(complaints).toEqual([]);
  });

  it.each([
    ['1', false],
    ['ArrowLeft', false],
    ['2', true],
    ['ArrowRight', true],
  ])('takes %s for an answer, once', async (key, positive) => {
    const { page, study } = await participantAt('question');
    await settle(page);
    await page.keyboard.press(key);
    await page.keyboard.press(key);
    await shows(page, 'feedback');
    expect(study.given.map((answer) => answer.positive)).toEqual([positive]);
  });

  it('counts neither a key that is held down nor one of the first moment', async () => {
    const { page, study } = await participantAt('interval', 2);
    await settle(page);
    await touchSoil(page);
    await page.keyboard.down('2');
    // A key at the moment when the question appears.
    await page.evaluate(() =>
      new MutationObserver(([change]) => {
        if ((change!.target as HTMLElement).dataset.phase === 'question')
          dispatchEvent(new KeyboardEvent('keydown', { key: '1' }));
      }).observe(document.querySelector('.participant')!, { attributeFilter: ['data-phase'] }),
    );
    await page.keyboard.press('Enter');
    await shows(page, 'question');
    await page.keyboard.down('2'); // held down: repeats
    await settle(page);
    await page.keyboard.down('2');
    await page.waitForTimeout(200);
    expect(study.given).toEqual([]);
    expect(study.phase).toBe('question');
    await page.keyboard.up('2');
    await page.keyboard.press('2');
    await shows(page, 'feedback');
    expect(study.given).toHaveLength(1);
  });

  it('takes an answer with the mouse, and says again what could not be sent', async () => {
    const { page, study } = await participantAt('question');
    const obey = study.obey.bind(study);
    study.obey = () => 'the disk is full';
    await settle(page);
    await page.getByRole('button', { name: 'Harder' }).click();
    await page.getByText('The disk is full.').waitFor();
    expect(await page.getByRole('button', { name: 'Harder' }).isEnabled()).toBe(true);
    study.obey = obey;
    await page.getByRole('button', { name: 'Harder' }).click();
    await shows(page, 'feedback');
    expect(study.given).toHaveLength(1);
  });

  it('tells nothing of what is shown', async () => {
    const { page } = await participantAt('interval');
    await page.waitForFunction(() => window.haptolith!.framesDrawn > 1);
    const text = await page.locator('body').innerText();
    expect(text).not.toMatch(/P\d|Moon|Mars|\d\s*N\b|friction/i);
    expect(await page.title()).toBe('Study, haptolith');
    for (const panel of ['.readouts', '.plots', '.controls', '.strip', '.legend'])
      expect(await page.locator(panel).count()).toBe(0);
  });

  it('goes on from an interval only after the soil was touched, and says so', async () => {
    const { page, study } = await participantAt('interval');
    await page.getByText('Touch the soil with the tool first.').waitFor();
    expect(await page.getByRole('button', { name: 'Continue' }).isDisabled()).toBe(true);
    await settle(page);
    await page.keyboard.press('Enter');
    await page.waitForTimeout(300);
    expect(study.phase).toBe('interval');
    await touchSoil(page);
    expect(await page.getByText('Touch the soil with the tool first.').count()).toBe(0);
    await page.keyboard.press('Enter');
    await page.getByRole('heading', { name: 'Second' }).waitFor();
  });

  it('shows the tool beside the name of the interval, not under it', async () => {
    const { page } = await participantAt('interval');
    await page.waitForFunction(() => window.haptolith!.ready);
    await page.waitForTimeout(500);
    const { y } = await toolOnScreen(page);
    const label = (await page.locator('.interval-label').boundingBox())!;
    expect(y).toBeGreaterThan(label.y + label.height);
  });

  it('lets the mouse hold the tool in an interval, and takes it away after', async () => {
    const { page, study } = await participantAt('interval');
    await page.waitForFunction(() => window.haptolith!.ready);
    const at = await toolOnScreen(page);
    await page.mouse.move(at.x, at.y);
    await page.mouse.down();
    await page.waitForFunction(() => window.haptolith!.frame!.held);
    const before = (await page.evaluate(() => window.haptolith!.frame!.tool.position_m)) as number[];
    await page.mouse.move(at.x + 60, at.y, { steps: 4 });
    await page.waitForFunction((x) => window.haptolith!.frame!.tool.position_m[0] !== x, before[0]!);
    study.skipTo('question');
    await shows(page, 'question');
    await page.waitForFunction(() => !window.haptolith!.frame!.held);
    await page.mouse.up();
  });

  it('is blank where the study is by feel alone, and the mouse digs all the same', async () => {
    const { page } = await participantAt('interval', 1, { visual: false });
    expect(await page.locator('.participant > .view').evaluate((view) => getComputedStyle(view).opacity)).toBe('0');
    await page.mouse.move(400, 300);
    await page.mouse.down();
    await page.waitForFunction(() => window.haptolith!.frame?.held === true);
    await page.mouse.up();
  });

  it('shows the tool later than it moves where the study says so', async () => {
    const delay_ms = 1500;
    const { page } = await participantAt('interval', 1, { visual_delay_s: delay_ms / 1000 });
    const waited_ms = await page.evaluate(async () => {
      const bed = window.haptolith!;
      const felt_s = bed.frame!.time_s;
      const began_ms = performance.now();
      while (bed.seen_s! < felt_s) await new Promise(requestAnimationFrame);
      return performance.now() - began_ms;
    });
    expect(waited_ms).toBeGreaterThan(0.9 * delay_ms);
    expect(waited_ms).toBeLessThan(2 * delay_ms);
  });

  it('demands what is required and has no position on a scale before it is touched', async () => {
    const { page, study } = await participantAt('form', 2);
    const sliders = page.locator('input[type=range]');
    expect(await sliders.count()).toBe(6);
    expect(await page.locator('input.unset').count()).toBe(6);
    await settle(page);
    await page.getByRole('button', { name: 'Continue' }).click();
    expect(await page.getByText('Please answer this question.').count()).toBe(6);
    const marks = 7;
    for (let i = 0; i < 6; ++i) {
      await sliders.nth(i).focus();
      await page.keyboard.press('Home');
      for (let k = 0; k < marks; ++k) await page.keyboard.press('ArrowRight');
    }
    await page.getByRole('button', { name: 'Continue' }).click();
    await shows(page, 'break');
    expect(Object.values(study.filled[0]!)).toEqual(Array(6).fill('35'));
  });

  it('takes a touch in the middle of a scale for an answer', async () => {
    const { page } = await participantAt('form', 2);
    const slider = page.locator('input[type=range]').first();
    const box = (await slider.boundingBox())!;
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    expect(await page.locator('input.unset').count()).toBe(5);
    expect(await slider.inputValue()).toBe('50');
  });

  it('asks twice before it withdraws', async () => {
    const { page, study } = await participantAt('question');
    await page.getByRole('button', { name: 'Stop taking part' }).click();
    await page.keyboard.press('2'); // no response while it asks
    await page.getByRole('button', { name: 'No, continue' }).click();
    expect(study.phase).toBe('question');
    await page.getByRole('button', { name: 'Stop taking part' }).click();
    await page.getByRole('button', { name: 'Stop', exact: true }).dblclick(); // the second click is ignored
    await page.waitForTimeout(300);
    expect(study.phase).toBe('question');
    const sure = page.getByRole('button', { name: 'Yes, stop' });
    if (!(await sure.isVisible())) {
      await page.getByRole('button', { name: 'Stop taking part' }).click();
      await page.getByRole('button', { name: 'Stop', exact: true }).click();
    }
    expect(study.phase).toBe('question');
    await sure.click();
    await shows(page, 'withdrawn');
    expect(study.phase).toBe('withdrawn');
    expect(study.given).toEqual([]);
    expect(await page.getByRole('button', { name: 'Stop taking part' }).isVisible()).toBe(false);
  });

  it('is thanked when the experimenter ends for today, and reads of no lost connection', async () => {
    const { page, study } = await participantAt('question');
    study.endForToday();
    await shows(page, 'stopped');
    await page.getByRole('heading', { name: 'Thank you, that is all for today' }).waitFor();
    await servers.pop()!.close();
    await page.waitForTimeout(1000);
    expect(await page.locator('.banner').isVisible()).toBe(false);
    expect(await page.getByRole('button', { name: 'Stop taking part' }).isVisible()).toBe(false);
  });

  it('says when the connection is lost, comes back by itself and goes on', async () => {
    const { page, study, address } = await participantAt('question');
    await servers.pop()!.close();
    await page.getByText('Connection lost').waitFor();
    const over = (await page.locator('.banner').boundingBox())!;
    expect([over.width, over.height]).toEqual([800, 600]); // nothing of the previous screen is visible around it
    await serve(study, Number(new URL(address).port));
    await page.waitForSelector('.participant:not(.offline)');
    await settle(page);
    await page.keyboard.press('1');
    await shows(page, 'feedback');
    expect(study.given).toHaveLength(1);
  });

  it('waits while there is no study', async () => {
    const server = new MockServer();
    servers.push(server);
    const { page } = await visit(`http://127.0.0.1:${await server.listen()}/`, 'participant');
    await page.locator('main').getByText('No study is running.', { exact: true }).waitFor();
  });

  it('reads what is shown aloud', async () => {
    const { page, study } = await participantAt('interval');
    const aloud = page.locator('[aria-live=polite].only-read-aloud');
    expect(await aloud.innerText()).toBe('First');
    study.skipTo('question');
    await shows(page, 'question');
    expect(await aloud.innerText()).toBe('Was the second harder to dig in than the first?');
  });
});

describe("the experimenter's page", () => {
  async function unblind(page: Page): Promise<void> {
    await page.getByRole('button', { name: 'Unblind…' }).click();
    await page.getByRole('button', { name: 'Unblind', exact: true }).click();
    await page.getByRole('button', { name: 'Blind again' }).waitFor();
  }

  async function experimenter(prepare: (study: MockStudy) => void) {
    const study = new MockStudy(SLOW);
    prepare(study);
    const watched = await visit(await serve(study), 'experimenter');
    await watched.page.getByText('S01').waitFor();
    return { ...watched, study };
  }

  it('shows how far the study is, what was answered and the curves', async () => {
    const { page, complaints } = await experimenter((study) => study.skipTo('question', 12));
    await page.getByText('part 1 of 2 · trial 12 of 17').waitFor();
    expect(await page.locator('tbody tr').count()).toBe(11);
    await unblind(page);
    await page.getByText('answering', { exact: true }).waitFor();
    expect(await page.locator('.psychometric').count()).toBe(2);
    expect(await page.locator('.psychometric').first().locator('.point').count()).toBeGreaterThan(2);
    expect(await page.locator('.psychometric .curve').count()).toBe(1);
    await page.getByText(/PSE 0\.86/).waitFor();
    expect(complaints).toEqual([]);
  });

  it('hides what is shown and what was right until the experimenter is unblinded, which is noted', async () => {
    const { page, study } = await experimenter((study) => study.skipTo('question', 3));
    const hidden = async (): Promise<void> => {
      expect(await page.locator('.right').innerText()).not.toMatch(/P\d|✓|✕/);
      expect(await page.locator('.psychometric:visible').count()).toBe(0);
      expect(await page.getByRole('region', { name: 'Psychometric functions' }).innerText()).toMatch(/Hidden/);
      expect(await page.locator('header').innerText()).not.toMatch(/seen/);
    };
    await page.locator('tbody tr').first().waitFor();
    await hidden();
    await page.getByRole('button', { name: 'Unblind…' }).click();
    await page.getByRole('button', { name: 'Stay blinded' }).click();
    await hidden();
    expect(study.written).toEqual([]);
    await unblind(page);
    await page.getByRole('region', { name: 'Shown now' }).getByText('P3').waitFor();
    await page.getByText('group seen').waitFor();
    expect(await page.locator('tbody').innerText()).toMatch(/✓|✕/);
    expect(await page.locator('.no-results:visible').count()).toBe(0);
    expect(study.written.map(({ text }) => text)).toEqual([expect.stringMatching(/^unblinded/)]);
    await page.getByRole('button', { name: 'Blind again' }).click();
    await page.getByRole('button', { name: 'Unblind…' }).waitFor();
    await hidden();
  });

  it('stays blinded when that cannot be noted', async () => {
    const { page, study } = await experimenter((study) => study.skipTo('question', 3));
    study.obey = () => 'the disk is full';
    await page.getByRole('button', { name: 'Unblind…' }).click();
    await page.getByRole('button', { name: 'Unblind', exact: true }).click();
    await page.getByText(/disk is full/i).waitFor();
    expect(await page.locator('.right').innerText()).not.toMatch(/P\d/);
  });

  it('pauses and goes on, for the participant too', async () => {
    const { page, study } = await experimenter((study) => study.skipTo('question'));
    await page.keyboard.press('p');
    await page.getByRole('button', { name: 'Resume' }).waitFor();
    expect(study.phase).toBe('paused');
    await page.getByRole('button', { name: 'Resume' }).click();
    await page.getByRole('button', { name: 'Pause' }).waitFor();
    expect(study.phase).toBe('question');
  });

  it('repeats a trial only with a reason, and keeps its answer', async () => {
    const { page, study } = await experimenter((study) => study.skipTo('feedback'));
    await page.getByRole('button', { name: 'Repeat a trial…' }).click();
    const repeat = page.getByRole('button', { name: 'Repeat trial' });
    expect(await repeat.isDisabled()).toBe(true);
    await page.getByRole('button', { name: 'distracted' }).click();
    await repeat.click();
    await page.getByText('repeated: distracted').waitFor();
    expect(study.given.at(-1)).toMatchObject({ state: 'repeated', reason: 'distracted' });
    await page.waitForFunction(() => !document.querySelector('dialog'));
  });

  it('keeps notes', async () => {
    const { page, study } = await experimenter((study) => study.skipTo('interval'));
    await page.keyboard.press('n');
    await page.keyboard.type('holds it like a pen');
    await page.keyboard.press('Enter');
    await page.locator('.notes-card li').getByText('holds it like a pen').waitFor();
    expect(study.written.map(({ text }) => text)).toEqual(['holds it like a pen']);
    expect(await page.getByRole('textbox', { name: 'Note' }).inputValue()).toBe('');
  });

  it('ends for today after asking, and shows a problem', async () => {
    const { page, study } = await experimenter((study) => study.skipTo('interval'));
    study.problem = 'The device does not answer.';
    await page.getByRole('alert').getByText('The device does not answer.').waitFor();
    await page.getByRole('button', { name: 'End for today…' }).click();
    await page.getByRole('button', { name: 'Cancel' }).click();
    expect(study.phase).toBe('interval');
    await page.getByRole('button', { name: 'End for today…' }).click();
    await page.getByRole('button', { name: 'End for today', exact: true }).click();
    await page.getByText(ENDED).waitFor();
    await page.waitForTimeout(1000); // the program would end now
    expect(await page.locator('.banner').isVisible()).toBe(false);
    for (const name of ['Pause', 'Repeat a trial…', 'Note', 'End for today…', 'Unblind…'])
      expect(await page.getByRole('button', { name, exact: true }).isDisabled()).toBe(true);
    expect(await page.locator('.participant-code').textContent()).toBe('S01');
  });

  it('shows the scene but does not hold the tool', async () => {
    const { page } = await experimenter((study) => study.skipTo('interval'));
    await page.waitForFunction(() => window.haptolith!.ready);
    const at = await toolOnScreen(page);
    await page.mouse.move(at.x, at.y);
    await page.mouse.down();
    await page.mouse.move(at.x + 40, at.y, { steps: 4 });
    await page.waitForTimeout(200);
    expect(await page.evaluate(() => window.haptolith!.frame!.held)).toBe(false);
    await page.mouse.up();
  });
});
