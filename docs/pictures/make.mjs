/**
 * Pictures of the viewer: a recorded log, mapped by a real server and looked at in a real browser.
 *
 *   ./scanloom pictures LOG [DIRECTORY [SONAR]]
 *
 * SONAR: a folder with measurement.txt and poses.txt of a ring of sonars.
 */
import { mkdir } from 'node:fs/promises';
import { join } from 'node:path';
import { launchBrowser, openPage } from '../../tests/e2e/browser.mjs';
import { ended, Server, startRobot } from '../../tests/e2e/programs.mjs';

const [log, directory, sonar] = process.argv.slice(2);
const kSize = [1280, 800];
const kPhone = [390, 844];

/** What each picture shows: the layer in the address, and what a person does until it is there. */
const kPictures = [
  { name: 'viewer-occupancy' },
  { name: 'viewer-classes', hash: '&layer=classification' },
  { name: 'viewer-himm', hash: '&layer=himm', act: counters },
  { name: 'viewer-swipe', hash: '&layer=classification', act: (page) => page.selectOption('#second-layer', 'himm') },
  { name: 'viewer-frontiers', act: (page) => page.check('[data-switch=frontiers]') },
  { name: 'viewer-history', act: history },
  { name: 'viewer-path', act: planPath },
  { name: 'viewer-difference', act: difference },
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
  if (sonar) {
    const files = [join(sonar, 'measurement.txt'), join(sonar, 'poses.txt')];
    await ended(startRobot(server, 'sonar', 'r1', ['sonar', ...files]));
    await take({ name: 'viewer-sonar', session: 'sonar', hash: '&layer=sonar' });
  }
} finally {
  await browser.close();
  await server.stop();
}

async function take({
  name,
  session = 'intel',
  hash = '',
  size = kSize,
  scheme = 'light',
  scale = 1,
  act = async () => {},
}) {
  const address = `#session=${session}${hash}`;
  const { page } = await openPage(browser, server.address, { hash: address, size, scheme, scale, motion: 'reduce' });
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
    const before = await page.getAttribute('#scale', 'style');
    await page.mouse.wheel(0, -240);
    await page.waitForFunction((old) => document.querySelector('#scale').getAttribute('style') !== old, before);
  }
  await page.mouse.move(820, 380);
}

/** A third of the way through the run. */
async function history(page) {
  await page.keyboard.press('t');
  await page.waitForFunction(() => document.querySelector('#time-slider').max > 1);
  await page.$eval('#time-slider', (slider) => {
    slider.value = String(Math.round(slider.max / 3));
    slider.dispatchEvent(new Event('input', { bubbles: true }));
  });
  await page.waitForFunction(() => /past/i.test(document.querySelector('#time-mode').textContent));
}

/** From one side of the building to the other. */
async function planPath(page) {
  await page.keyboard.press('p');
  await page.mouse.click(673, 500);
  await page.mouse.click(1043, 560);
  await page.waitForSelector('#tool-body dl');
}

/** The same scans at cells of twice the size. */
async function difference(page) {
  await page.keyboard.press('w');
  await page.fill('#tool-body [name=cell_size]', '0.1');
  await page.click('#tool-body :text-is("Weave")');
  await page.waitForSelector('#swipe', { state: 'visible' });
  await page.check('[name=difference]');
}
