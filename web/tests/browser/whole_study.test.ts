// The study of icra2021 from consent to thanks, with the program, which is killed in the middle of every block. No
// response is lost or duplicated, and a resumed study continues in the same order.

import { execFileSync, spawn, type ChildProcess } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { grabTool, launch, newPage } from './pages';

const executable = process.env.HAPTOLITH ?? '';
const TRIALS = 15; // per block
const KILLED_AT: [number, string][] = [
  [7, 'interval'],
  [9, 'question'],
  [TRIALS + 4, 'question'],
  [TRIALS + 8, 'interval'],
];

let browser: Browser;
let folder: string;
const running: ChildProcess[] = [];

beforeAll(async () => {
  browser = await launch();
  folder = mkdtempSync(join(tmpdir(), 'haptolith-study-'));
});

afterAll(async () => {
  await browser?.close();
  for (const child of running) child.kill('SIGKILL');
  rmSync(folder, { recursive: true, force: true });
});

const study = (): string => join(folder, 'icra2021.study');
const tell = (...words: string[]): string => execFileSync(executable, ['study', ...words], { encoding: 'utf8' });

/** Starts the study and waits for the participant's address. */
function lead(how: 'run' | 'resume', port: string): Promise<{ child: ChildProcess; address: string }> {
  // A fixed token for all runs, so that the page finds the program again.
  const env = { ...process.env, HAPTOLITH_PARTICIPANT_TOKEN: 'the_same_one_in_all_runs' };
  const child = spawn(executable, ['study', how, study(), '--port', port, ...(how === 'run' ? ['--trial-run'] : [])], {
    env,
    stdio: ['ignore', 'ignore', 'pipe'],
  });
  running.push(child);
  return new Promise((resolve, reject) => {
    let said = '';
    child.stderr!.setEncoding('utf8').on('data', (text: string) => {
      said += text;
      const found = /participant's page\s+(\S+)/.exec(said);
      if (found) resolve({ child, address: found[1]! });
    });
    child.once('exit', (code) => reject(new Error(`ended with ${code}:\n${said}`)));
  });
}

function kill(child: ChildProcess): Promise<void> {
  return new Promise((resolve) => {
    child.once('exit', () => resolve());
    child.kill('SIGKILL');
  });
}

interface Row {
  [column: string]: string;
}

function rows(): Row[] {
  const file = join(folder, 'answers.csv');
  tell('export', study(), '--out', file, '--overwrite');
  const [head, ...lines] = readFileSync(file, 'utf8').trim().split('\n');
  const columns = head!.split(',');
  return lines.map((line) => {
    const values = line.split(',');
    return Object.fromEntries(columns.map((column, i) => [column, values[i] ?? '']));
  });
}

const phaseOf = (page: Page): Promise<string> =>
  page.evaluate(() => document.querySelector<HTMLElement>('.participant')?.dataset.phase ?? '');

/** Acts on the current screen, as a participant who always perceives the second soil as stronger. */
async function act(page: Page, phase: string): Promise<void> {
  if (phase === 'form') {
    for (const choice of ['right', 'never'])
      for (const button of await page.locator(`input[value="${choice}"]`).all()) await button.check();
    await page.locator('.form').evaluate((form: HTMLFormElement) => form.requestSubmit());
  } else if (phase === 'question') {
    await page.keyboard.press('2');
  } else if (phase === 'interval') {
    await page.keyboard.down('PageDown'); // into the soil: the study continues only after a touch
    await page.waitForFunction(() => !document.querySelector('.participant[data-phase=interval] .go:disabled'));
    await page.keyboard.up('PageDown');
    await page.keyboard.press('Enter');
  } else if (['consent', 'instructions', 'break'].includes(phase)) {
    await page.keyboard.press('Enter');
  }
  await page.waitForTimeout(120);
}

describe.skipIf(executable === '')('a whole study', () => {
  it('loses no answer and doubles none when the program is killed', { timeout: 1_200_000 }, async () => {
    tell('new', study(), '--protocol', 'icra2021', '--seed', '1');
    let { child, address } = await lead('run', '0');
    const port = new URL(address).port;
    const { page, complaints } = await newPage(browser);
    await page.goto(address);

    const kills = [...KILLED_AT];
    let answers = 0;
    let dug = false;
    let before = '';
    for (;;) {
      const phase = await phaseOf(page);
      if (phase === 'finished') break;
      if (before === 'question' && phase !== 'question' && phase !== 'paused' && phase !== '') ++answers;
      before = phase;
      if (kills.length > 0 && answers >= kills[0]![0] && phase === kills[0]![1]) {
        kills.shift();
        await kill(child);
        before = '';
        ({ child } = await lead('resume', port));
        await page.getByRole('heading', { name: 'Welcome back' }).waitFor();
      } else if (!dug && phase === 'interval') {
        await grabTool(page);
        await page.mouse.move(400, 500, { steps: 5 });
        await page.mouse.up();
        dug = true;
      } else {
        await act(page, phase);
      }
    }
    expect(kills).toEqual([]);
    expect(complaints).toEqual([]);
    child.kill('SIGINT');

    const all = rows();
    const kept = all.filter((row) => row.state === 'answered');
    expect(kept).toHaveLength(2 * TRIALS);
    expect(new Set(kept.map((row) => `${row.block} ${row.trial}`)).size).toBe(2 * TRIALS);
    expect(all.filter((row) => row.state === 'lost')).toHaveLength(KILLED_AT.length);
    for (const block of ['friction', 'gravity']) {
      const levels = kept.filter((row) => row.block === block).map((row) => row.level);
      for (const level of new Set(levels)) expect(levels.filter((other) => other === level)).toHaveLength(3);
    }
    // The order was drawn before the first kill: one block, then the other.
    expect(kept.map((row) => row.block)).toEqual([...Array(TRIALS).fill('friction'), ...Array(TRIALS).fill('gravity')]);

    // The next participant begins with the other block.
    ({ child, address } = await lead('run', '0'));
    await page.goto(address);
    for (let phase = ''; phase !== 'interval'; phase = await phaseOf(page)) await act(page, phase);
    await kill(child);
    expect(rows().filter((row) => row.participant === 'S02').map((row) => row.block)).toEqual(['gravity']); // prettier-ignore
  });
});
