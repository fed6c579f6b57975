/**
 * Pictures of the viewer: a recorded log, mapped by a real server and looked at in a real browser.
 *
 *   ./scanloom pictures LOG [DIRECTORY]
 */
import { mkdir } from 'node:fs/promises';
import { join } from 'node:path';
import { launchBrowser, openPage } from '../../tests/e2e/browser.mjs';
import { ended, Server, startRobot } from '../../tests/e2e/programs.mjs';

const [log, directory] = process.argv.slice(2);
const kSize = [1280, 800];
const kPhone = [390, 844];

/** What each picture shows: the layer in the address, and what a person does until it is there. */
const kPictures = [
  { name: 'viewer-occupancy' },
  { name: 'viewer-classes', hash: '&layer=classification' },
  { name: 'viewer-himm', hash: '&layer=himm', act: counters },
  { name: 'viewer-swipe', hash: '&layer=classification', act: (page) => page.selectOption('#beside', 'himm') },
  { name: 'viewer-frontiers', act: (page) => page.check('[data-switch=frontiers]') },
  { name: 'viewer-dark', hash: '&layer=classification', scheme: 'dark' },
  { name: 'viewer-safe', hash: '&layer=classification', act: (page) => page.selectOption('#palette', 'safe') },
  { name: 'viewer-phone', size: kPhone, scale: 2 },
];

await mkdir(directory, { recursive: true });
const server = await Server.start();
const browser = await launchBrowser();
try {
  const code = await ended(startRobot(server, 'intel', 'r1', ['replay', log]));
  if (code !== 0) throw new Error(`the log ${log} could not be replayed`);
  for (const picture of kPictures) await take(picture);
} finally {
  await browser.close();
  await server.stop();
}

async function take({ name, hash = '', size = kSize, scheme = 'light', scale = 1, act = async () => {} }) {
  const { page } = await openPage(browser, server.address, { hash: `#session=intel${hash}`, size, scheme, scale });
  await page.emulateMedia({ colorScheme: scheme, reducedMotion: 'reduce' });
  await page.waitForSelector('#notice', { state: 'hidden' });
  await act(page);
  await page.waitForLoadState('networkidle');
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  const path = join(directory, `${name}.png`);
  await page.screenshot({ path });
  await page.context().close();
  console.log(path);
}

/** So near that cells hold their counters. */
async function counters(page) {
  await page.check('[data-switch=counters]');
  await page.mouse.move(780, 332);
  for (let step = 0; step < 6; ++step) {
    await page.mouse.wheel(0, -240);
    await page.waitForTimeout(400);
  }
  await page.mouse.move(820, 380);
}
