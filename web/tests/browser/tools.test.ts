import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, it } from 'vitest';
import { MockServer } from '../mock-server';
import { grabTool, launch, openPage, violations } from './pages';

let browser: Browser;
let server: MockServer;
let address: string;

beforeAll(async () => {
  server = new MockServer({ two_tools: true });
  address = `http://127.0.0.1:${await server.listen()}/`;
  browser = await launch();
});

afterAll(async () => {
  await browser?.close();
  await server?.close();
});

const untilHeld = (page: Page, wished: number[]): Promise<unknown> =>
  page.waitForFunction(
    (by) => JSON.stringify(window.haptolith!.frame!.tools.map(({ held_by }) => held_by)) === JSON.stringify(by),
    wished,
  );

it('two visitors hold one tool each', async () => {
  const one = await openPage(browser, address);
  const other = await openPage(browser, address);
  const right = other.page.getByRole('group', { name: 'Tool to hold' }).getByRole('button', { name: 'right' });
  await right.click();
  expect(await right.getAttribute('aria-pressed')).toBe('true');
  expect(await other.page.locator('[data-shape=sphere]').isVisible()).toBe(false);
  await grabTool(other.page);
  await untilHeld(one.page, [0, 2]);
  await one.page.getByRole('button', { name: 'right (held)' }).waitFor();
  expect(await violations(one.page)).toEqual([]);
  await grabTool(one.page);
  await untilHeld(other.page, [1, 2]);
  await one.page.mouse.up();
  await untilHeld(other.page, [0, 2]);
  await other.page.close();
  await untilHeld(one.page, [0, 0]);
  expect([...one.complaints, ...other.complaints]).toEqual([]);
});
