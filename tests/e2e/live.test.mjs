/** The real robot client, the real server and the viewer: a robot streams while the map grows on the page. */
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import {
  colourOf,
  colourScheme,
  countPixels,
  keepPicture,
  launchBrowser,
  openPage,
  openTab,
  hasText,
  showsColour,
  textOf,
} from './browser.mjs';
import { Server, startRobot, stop } from './programs.mjs';

const kSource = ['simulate', '--world', 'office', '--drive', 'wall_follower', '--seed', '1', '--speed', '4'];

describe('a robot that streams to the server', () => {
  let server;
  let robot;
  let browser;
  let page;
  let complaints;

  before(async () => {
    server = await Server.start();
    browser = await launchBrowser();
    ({ page, complaints } = await openPage(browser, server.address));
  });

  after(async () => {
    await browser?.close();
    if (robot) await stop(robot);
    await server?.stop();
  });

  it('opens its session in a waiting page', async () => {
    await hasText(page, '#notice', new RegExp(`No sessions yet.*--server 127\\.0\\.0\\.1:${server.robotPort} `, 's'));
    robot = startRobot(server, 'demo', 'r1', kSource);
    await page.waitForSelector('#notice', { state: 'hidden' });
    await page.waitForSelector('[data-robot="r1"]');
    assert.match(page.url(), /#session=demo$/);
  });

  it('changes tiles, and the page fetches each under its new version', async () => {
    const versions = new Map();
    for (let changed = 0; changed < 3; ) {
      const answer = await page.waitForResponse((response) => /\/tiles\/occupancy\/.*\.png\?/.test(response.url()));
      assert.equal(answer.status(), 200);
      const url = new URL(answer.url());
      const version = Number(url.searchParams.get('v'));
      const last = versions.get(url.pathname);
      if (last !== undefined) {
        assert.ok(version > last, `${url.pathname} fetched again at version ${version}`);
        changed += 1;
      }
      versions.set(url.pathname, version);
    }
  });

  it('moves on the page, and draws its trail', async () => {
    const pose = '[data-robot="r1"] [data-role="pose"]';
    const before = await textOf(page, pose);
    await page.waitForFunction(([at, old]) => document.querySelector(at)?.textContent !== old, [pose, before]);
    await hasText(page, '[data-robot="r1"] .row-detail', /online .* [1-9]\d*\.\d m/);
    assert.ok((await countPixels(page, await colourOf(page, '--robot-0'))) > 100, 'marker and path are drawn');
  });

  it('is followed, and what lies beneath it is read as free', async () => {
    await page.click('[data-robot="r1"] .follow');
    await page.focus('#map');
    await page.hover('#map');
    await hasText(page, '#cursor-value', /^\d+ % occupied$/);
    assert.match(await textOf(page, '#cursor-x'), /^\u2212?\d+\.\d\d$/);
    await page.click('#fit');
  });

  it('is shown after a reload, and in a second tab', async () => {
    const isShown = async (tab) => {
      await tab.waitForSelector('[data-robot="r1"]');
      await hasText(tab, '#sessions', /demo/);
      await showsColour(tab, '--cell-free');
    };
    await page.reload();
    await isShown(page);
    const tab = await openTab(page.context(), server.address, complaints);
    await isShown(tab);
    await tab.close();
    assert.deepEqual(complaints, []);
  });

  it('leaves its map and trail after it has stopped', async () => {
    await hasText(page, '[data-robot="r1"] .row-detail', /[1-9]\d+(\.\d)? m/);
    await keepPicture(page, 'live-light');
    await colourScheme(page, 'dark');
    await showsColour(page, '--cell-free');
    await keepPicture(page, 'live-dark');
    assert.deepEqual(complaints, []);
  });
});
