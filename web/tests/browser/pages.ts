// A browser for the tests, and common actions on a page.

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import type { Browser, Page } from 'playwright-core';
import { expect } from 'vitest';

export { launch, launchWithoutWebGl } from './launch';

// Long enough for software rendering in parallel with other work on two cores; not a measure of speed.
const WAIT_MS = 150_000;

const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
interface Axe {
  run(options: object): Promise<{ violations: { id: string; nodes: { html: string }[] }[] }>;
}

/** Returns the accessibility violations that axe finds, with their elements. */
export async function violations(page: Page): Promise<string[]> {
  // The page's policy rejects inline scripts; the browser's console can evaluate them.
  await page.evaluate(AXE);
  const found = await page.evaluate(async () => {
    const { axe } = window as unknown as { axe: Axe };
    return (await axe.run({ resultTypes: ['violations'] })).violations;
  });
  return found.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 160)).join(' | ')}`);
}

export interface Watched {
  page: Page;
  /** errors and warnings on the console, and uncaught errors */
  complaints: string[];
}

// Messages of the software renderer, and of a server that is down on purpose; not errors of the page.
const NOT_OURS = /GPU stall|swiftshader|GL Driver Message|ERR_CONNECTION_REFUSED|WebSocket connection to/i;

// Small pictures: the tests check behaviour, and every pixel is rendered in software.
const VIEWPORT = { width: 800, height: 600 };

/** Opens a page without an address. */
export async function newPage(browser: Browser): Promise<Watched> {
  const page = await browser.newPage({ viewport: VIEWPORT, reducedMotion: 'reduce' });
  const complaints: string[] = [];
  page.on('console', (message) => {
    const kind = message.type();
    if ((kind === 'error' || kind === 'warning') && !NOT_OURS.test(message.text())) complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(error.message));
  page.setDefaultTimeout(WAIT_MS);
  return { page, complaints };
}

export async function openPage(browser: Browser, address: string, script?: { content: string }): Promise<Watched> {
  const { page, complaints } = await newPage(browser);
  if (script) await page.addInitScript(script);
  await page.goto(address);
  await page.waitForFunction(() => window.haptolith?.ready === true);
  return { page, complaints };
}

export function scene(page: Page) {
  return page.evaluate(() => window.haptolith!.scene!);
}

export function frame(page: Page) {
  return page.evaluate(() => window.haptolith!.frame!);
}

/** Returns the position of the tool in the page; fails when it is outside the picture. */
export async function toolOnScreen(page: Page): Promise<{ x: number; y: number }> {
  const at = await page.evaluate(() => window.haptolith!.toolOnScreen);
  expect(at).not.toBeNull();
  return at!;
}

/** Stops the simulated hand, so that the tool stays in place until the test takes it. */
export async function holdStill(page: Page): Promise<void> {
  await page.keyboard.press('y');
  await page.waitForFunction(() => window.haptolith!.scene!.hand.motion === 'still');
  await page.waitForFunction(() => {
    const memory = window as unknown as { last_z?: number };
    const z = window.haptolith!.frame!.tool.position_m[2];
    const same = memory.last_z !== undefined && Math.abs(memory.last_z - z) < 2e-5;
    memory.last_z = z;
    return same;
  }, null, { polling: 200 }); // prettier-ignore
}

/** Takes the tool with the mouse and keeps the button pressed. */
export async function grabTool(page: Page): Promise<{ x: number; y: number }> {
  const at = await toolOnScreen(page);
  await page.mouse.move(at.x, at.y);
  await page.mouse.down();
  await page.waitForFunction(() => window.haptolith!.frame!.held);
  return at;
}

/** Pulls the tool, which the mouse holds at `at`, down into the soil until the soil pushes back. */
export async function pullIntoSoil(page: Page, at: { x: number; y: number }): Promise<void> {
  let down_px = 0;
  await expect
    .poll(
      async () => {
        down_px = Math.min(down_px + 25, 400);
        await page.mouse.move(at.x + down_px / 10, at.y + down_px);
        return Math.hypot(...(await frame(page)).force_n);
      },
      { timeout: WAIT_MS, interval: 150 },
    )
    .toBeGreaterThan(0.05);
}

/** Returns red, green, blue and opacity of each pixel of a part of the page, 0 to 255. */
export async function pixelsIn(
  page: Page,
  clip: { x: number; y: number; width: number; height: number },
): Promise<number[]> {
  const picture = (await page.screenshot({ clip })).toString('base64');
  return page.evaluate(async (text) => {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d', { willReadFrequently: true })!;
    canvas.drawImage(bitmap, 0, 0);
    return [...canvas.getImageData(0, 0, bitmap.width, bitmap.height).data];
  }, picture);
}
