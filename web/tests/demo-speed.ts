// npm run demo-speed -- FOLDER [SCENE...]: measures the demo in FOLDER, in a browser without a graphics card: time to
// the first frame, transferred bytes, and speed of its soil.

import { launch } from './browser/launch';
import { serveFolder } from './static-server';

const LOOK_S = 20;

const [folder, ...scenes] = process.argv.slice(2);
if (!folder) throw new Error('npm run demo-speed -- FOLDER [SCENE...]');
const host = await serveFolder(folder);
const browser = await launch();
try {
  for (const scene of scenes.length > 0 ? scenes : ['moon', 'icra2021']) {
    host.sent.clear();
    const page = await browser.newPage({ viewport: { width: 800, height: 600 } });
    const begun_ms = performance.now();
    await page.goto(`${host.address}?scene=${scene}`);
    await page.waitForFunction(() => window.haptolith?.ready === true, null, { timeout: 120_000 });
    const first_s = (performance.now() - begun_ms) / 1000;
    const time = (): Promise<[number, number]> =>
      page.evaluate(() => [window.haptolith!.frame!.time_s, performance.now() / 1000]);
    const [start_s, at_s] = await time();
    await page.waitForTimeout(1000 * LOOK_S);
    const [end_s, then_s] = await time();
    const status = await page.evaluate(() => window.haptolith!.status!);
    const sent_mb = [...host.sent.values()].reduce((sum, bytes) => sum + bytes) / 1e6;
    console.log(
      `${scene}: ${status.particles} particles, first picture after ${first_s.toFixed(1)} s of ${sent_mb.toFixed(1)} MB, ` +
        `${((end_s - start_s) / (then_s - at_s)).toFixed(3)} s of soil a second, ` +
        `tick p50 ${status.tick_us.p50.toFixed(0)} us, p99 ${status.tick_us.p99.toFixed(0)} us`,
    );
    await page.close();
  }
} finally {
  await browser.close();
  await host.close();
}
