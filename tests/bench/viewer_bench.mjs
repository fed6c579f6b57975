/**
 * The speed of the viewer in headless Chromium: its size, the first map, and frames while tiles change.
 *
 *   SCANLOOM_WEB_DIR=build/web SCANLOOM_BIN_DIR=build/bin SCANLOOM_PICTURE_DIR=build/e2e node tests/bench/viewer_bench.mjs [--quick]
 */
import { readdir, readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { kWebDirectory, launchBrowser, openPage, showsColour } from '../e2e/browser.mjs';
import { FakeServer } from '../e2e/fake_server.mjs';
import { FakeSession } from '../e2e/fake_session.mjs';
import { startRobot, stop } from '../e2e/programs.mjs';
import { startServer } from './load_runs.mjs';
import { announce, fullOrQuick } from './report/arguments.mjs';

const kRounds = fullOrQuick(9, 3);
const kSeconds = fullOrQuick(10, 2);
/** Native tiles, which this screen shows slightly reduced. */
const kAcross = 10;
const kDown = 6;
const kScreen = [2560, 1440];
const kChangesPerSecond = 20;

announce('viewer', '1 minute', '30 seconds');
const browser = await launchBrowser();
await measureSize();
await measureFirstMap();
await measureFrames();
await browser.close();

/** Compressed bytes that a browser fetches for the page. */
async function measureSize() {
  const assets = join(kWebDirectory, 'assets');
  const files = [join(kWebDirectory, 'index.html'), ...(await readdir(assets)).map((file) => join(assets, file))];
  const sizes = await Promise.all(files.map(async (file) => gzipSync(await readFile(file), { level: 9 }).length));
  const bytes = sizes.reduce((sum, size) => sum + size, 0);
  printRow('page, gzip', `${(bytes / 1000).toFixed(0)} kB`);
}

/** Time from entering the address to drawn cells, with the real server and an empty cache. */
async function measureFirstMap() {
  const server = await startServer();
  const robot = startRobot(server, 'office', 'r1', [
    'simulate',
    '--world',
    'office',
    '--drive',
    'wall_follower',
    '--seed',
    '1',
    '--speed',
    '20',
  ]);
  await scansOf(server, 600);
  await stop(robot);
  const times = [];
  for (let round = 0; round < kRounds; ++round) {
    const { page } = await openPage(browser, server.address, { hash: '#session=office' });
    await showsColour(page, '--cell-free');
    times.push(await page.evaluate(() => performance.now()));
    await page.context().close();
  }
  await server.stop();
  times.sort((a, b) => a - b);
  printRow(
    'first map, median',
    `${times[Math.floor(kRounds / 2)].toFixed(0)} ms`,
    `slowest of ${kRounds}: ${times.at(-1).toFixed(0)} ms`,
  );
}

async function scansOf(server, count) {
  for (;;) {
    const answer = await fetch(`${server.address}api/v1/sessions/office`);
    if (answer.ok && (await answer.json()).scans >= count) return;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

/** The same page at rest and with changing tiles: frames per second, and requests per change. */
async function measureFrames() {
  const server = await FakeServer.start(kWebDirectory);
  const session = server.add(new FakeSession('wall', 'id-wall'));
  for (let tile = 0; tile < kAcross * kDown; ++tile) paint(session, tile, tile % 100);
  const { page } = await openPage(browser, server.address, { size: kScreen });
  await showsColour(page, '--cell-free');
  await page.waitForLoadState('networkidle');
  const shown = new Set(server.tileRequests.map((path) => path.split('?')[0])).size;
  const idle = await framesPerSecond(page);
  const requested = server.tileRequests.length;
  let changes = 0;
  const timer = setInterval(
    () => paint(session, (changes * 7) % (kAcross * kDown), changes++ % 100),
    1000 / kChangesPerSecond,
  );
  const busy = await framesPerSecond(page);
  clearInterval(timer);
  const perChange = (server.tileRequests.length - requested) / changes;
  printRow(`frames/s, ${shown} tiles at rest`, idle.rate.toFixed(1), `slowest of 100: ${idle.slow.toFixed(0)} ms`);
  printRow(
    `frames/s, ${(changes / kSeconds).toFixed(0)} of them changing a second`,
    busy.rate.toFixed(1),
    `slowest of 100: ${busy.slow.toFixed(0)} ms; ratio ${(busy.rate / idle.rate).toFixed(2)}`,
  );
  printRow('requests for a changed tile', perChange.toFixed(2));
  await page.context().close();
  await server.vanish();
}

function paint(session, tile, percent) {
  session.paint(256 + (tile % kAcross), 255 - Math.floor(tile / kAcross), percent);
}

/** @returns the rate, and the duration of the slowest of 100 frames, ms */
function framesPerSecond(page) {
  return page.evaluate(
    (durationMs) =>
      new Promise((resolve) => {
        const frames = [];
        const begin = performance.now();
        let last = begin;
        const look = (now) => {
          frames.push(now - last);
          last = now;
          if (now - begin < durationMs) return requestAnimationFrame(look);
          frames.sort((a, b) => a - b);
          resolve({ rate: (1000 * frames.length) / (now - begin), slow: frames[Math.floor(0.99 * frames.length)] });
        };
        requestAnimationFrame(look);
      }),
    1000 * kSeconds,
  );
}

function printRow(what, figure, note = '') {
  console.log(`${what.padEnd(46)}${figure.padStart(10)}${note && `   (${note})`}`);
}
