/** The history of a session: maps of earlier times that the real server computes, selected and played back. */
import assert from 'node:assert/strict';
import { after, afterEach, before, describe, it } from 'node:test';
import { colourOf, countPixels, keepPicture, launchBrowser, openPage, openTab, hasText, textOf } from './browser.mjs';
import { Server, startRobot } from './programs.mjs';

const kSimulation = ['simulate', '--world', 'office', '--drive', 'wall_follower', '--seed', '1', '--speed', '0'];
const kHash = '#session=run';
const kPose = '[data-robot="r1"] [data-role="pose"]';

describe('the history of a session', () => {
  let server;
  let browser;
  let page;
  let complaints;

  /** Continues the drive until the session is this many seconds long. */
  async function drive(seconds) {
    const robot = startRobot(server, 'run', 'r1', [...kSimulation, '--duration', String(seconds)]);
    await new Promise((resolve) => robot.once('exit', resolve));
    assert.equal(robot.exitCode, 0);
  }

  async function openHistory(tab) {
    await tab.click('#history-open');
    await tab.waitForFunction(() => Number(document.querySelector('#time-slider').max) > 1);
  }

  /** Moves the slider there and waits until the map shows that scan. */
  async function seek(tab, scan) {
    await tab.fill('#time-slider', String(scan));
    await showsScan(tab, scan);
  }

  async function showsScan(tab, scan) {
    await hasText(tab, '#time-mode', /^Past$/);
    await hasText(tab, '#time-place', new RegExp(`^scan ${scan} of `));
    await hasText(tab, '[data-robot="r1"] .row-detail', new RegExp(`\\b${scan} scans? `));
  }

  function valueOf(tab) {
    return tab.inputValue('#time-slider').then(Number);
  }

  function freePixels(tab) {
    return colourOf(tab, '--cell-free').then((colour) => countPixels(tab, colour));
  }

  /** Waits until this many pixels of the map are free. @param least, most pixels */
  async function showsFree(tab, least, most) {
    for (let [found, look] = [-1, 0]; found < least || found > most; found = await freePixels(tab), ++look) {
      assert.ok(look < 2000, `${found} free pixels, not ${least} to ${most}`);
      await tab.evaluate(() => new Promise(requestAnimationFrame));
    }
  }

  /** Returns the number of free pixels once the map no longer changes. */
  async function settledFree(tab) {
    let [found, same] = [-1, 0];
    for (let look = 0; same < 5; ++look) {
      assert.ok(look < 500, 'the map keeps changing');
      const next = await freePixels(tab);
      same = next === found ? same + 1 : 0;
      found = next;
      await tab.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
    }
    return found;
  }

  afterEach(() => page.unrouteAll());

  before(async () => {
    server = await Server.start();
    await drive(40);
    browser = await launchBrowser();
    ({ page, complaints } = await openPage(browser, server.address, { hash: kHash }));
    await page.waitForSelector('[data-robot="r1"]');
  });

  after(async () => {
    await browser?.close();
    await server?.stop();
  });

  it('opens as a bar below the map, in the present', async () => {
    await openHistory(page);
    assert.equal(await textOf(page, '#time-mode'), 'Live');
    assert.equal(await page.getAttribute('#time-slider', 'max'), '400');
    assert.match(await page.getAttribute('#time-slider', 'aria-valuetext'), /^scan 400 of 400, .*\+00:\d\d/);
    assert.equal(await page.getAttribute('#history-open', 'aria-expanded'), 'true');
  });

  it('shows an older map with the pose of the robot at that time; one click returns to the present', async () => {
    await showsFree(page, 5_000, Infinity);
    const [pose, present] = [await textOf(page, kPose), await settledFree(page)];
    await seek(page, 20);
    await showsFree(page, 100, 0.8 * present);
    assert.notEqual(await textOf(page, kPose), pose);
    assert.match(
      await textOf(page, '#time-note'),
      /as they were then.*newest scans, goals, frontiers and landmarks are hidden/,
    );
    await keepPicture(page, 'time-past-light');
    await page.click('#time-live');
    await hasText(page, '#time-mode', /^Live$/);
    await hasText(page, kPose, new RegExp(`^${pose.replace(/[.*+?^${}()|[\]\\]/g, '\\$&')}$`));
    await showsFree(page, 0.99 * present, 1.01 * present);
    assert.equal(await valueOf(page), 400);
  });

  it('shows the newest scan\u2019s map exactly like the present', async () => {
    const picture = () => page.locator('#map').screenshot();
    for (const overlay of ['points', 'robots']) await page.uncheck(`[data-switch="${overlay}"]`);
    await seek(page, 20);
    await settledFree(page);
    await seek(page, 400);
    const newest = await settledFree(page);
    const past = await picture();
    await page.click('#time-live');
    await hasText(page, '#time-mode', /^Live$/);
    assert.equal(await settledFree(page), newest);
    assert.ok(past.equals(await picture()), 'pixel by pixel');
    for (const overlay of ['points', 'robots']) await page.check(`[data-switch="${overlay}"]`);
  });

  it('plays at the chosen speed, and ends with the last scan', async () => {
    await page.selectOption('#time-speed', '20');
    const start = Date.now();
    await page.click('#time-play');
    await page.waitForSelector('#time-play[aria-label="Pause"]');
    await hasText(page, '#time-mode', /^Past$/);
    for (const least of [40, 150, 300]) {
      await page.waitForFunction((scan) => Number(document.querySelector('#time-slider').value) >= scan, least);
      if (least === 150) await keepPicture(page, 'time-playing');
    }
    await page.waitForSelector('#time-play[aria-label="Play"]');
    assert.ok(Date.now() - start > 1_800, '40 s at 20 times take 2 s');
    await showsScan(page, 400);
  });

  it('shows no blank frame during playback', async () => {
    await seek(page, 150);
    let most = await settledFree(page);
    await page.click('#time-play');
    for (let looks = 0; looks < 40 || (await valueOf(page)) < 250; ++looks) {
      const free = await freePixels(page);
      assert.ok(free > 0.97 * most, `${free} free pixels after ${most}`);
      most = Math.max(most, free);
    }
    await page.keyboard.press(',');
    await page.waitForSelector('#time-play[aria-label="Play"]');
  });

  it('requests one weave at a time, and of newer requests only the last', async () => {
    await seek(page, 10);
    const requested = [];
    let come;
    const first = new Promise((resolve) => (come = resolve));
    let release;
    const held = new Promise((resolve) => (release = resolve));
    await page.route('**/weave', async (route) => {
      requested.push(route.request().postDataJSON().until);
      come();
      if (requested.length === 1) await held;
      await route.continue();
    });
    const box = await page.locator('#time-slider').boundingBox();
    const y = box.y + box.height / 2;
    await page.mouse.move(box.x + 0.2 * box.width, y);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.8 * box.width, y, { steps: 60 });
    await page.mouse.up();
    const scan = await valueOf(page);
    assert.ok(scan > 250 && scan < 380, `dragged to ${scan}`);
    await first;
    assert.equal(requested.length, 1);
    release();
    await showsScan(page, scan);
    assert.equal(requested.length, 2);
  });

  it('works with the keyboard alone', async () => {
    await page.click('#time-close');
    await page.waitForSelector('#time-bar', { state: 'hidden' });
    assert.ok(await page.evaluate(() => document.activeElement.id === 'history-open'));
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press('t');
    await page.waitForFunction(() => Number(document.querySelector('#time-slider').max) > 1);
    const press = async (key, scan) => {
      await page.keyboard.press(key);
      await showsScan(page, scan);
    };
    await press('Home', 1);
    await press('ArrowRight', 2);
    await press('.', 3);
    await press(',', 2);
    await press('End', 400);
    await page.keyboard.press('Space');
    await page.waitForSelector('#time-play[aria-label="Pause"]');
    await page.keyboard.press('Space');
    await page.waitForSelector('#time-play[aria-label="Play"]');
    await page.keyboard.press('l');
    await hasText(page, '#time-mode', /^Live$/);
    await press(',', 399);
    await page.keyboard.press('t');
    await page.waitForSelector('#time-bar', { state: 'hidden' });
    await hasText(page, '[data-robot="r1"] .row-detail', /\b400 scans /);
  });

  it('shows the server\u2019s refusal, and keeps the map', async () => {
    await openHistory(page);
    await seek(page, 100);
    const before = await settledFree(page);
    const problem = (status, detail) => ({
      status,
      contentType: 'application/problem+json',
      body: JSON.stringify({ title: 'No', status, detail }),
    });
    await page.route('**/weave', (route) => route.fulfill(problem(507, '<b>no room</b> for maps')));
    await page.fill('#time-slider', '30');
    await hasText(page, '#time-message', /cannot be shown; the map stays as it is\. .*<b>no room<\/b> for maps\.$/);
    assert.equal(await freePixels(page), before);
    await hasText(page, '[data-robot="r1"] .row-detail', /\b100 scans /);
    await page.unroute('**/weave');

    await page.route('**/weave', (route) => route.fulfill(problem(503, 'too many weaves are running')));
    await page.fill('#time-slider', '31');
    await hasText(page, '#time-message', /too many weaves are running\. Trying again\.$/);
    await page.unroute('**/weave');
    await showsScan(page, 31);
    await hasText(page, '#time-message', /^$/);
  });

  it('continues when the server is online again', async () => {
    await page.route('**/weave', (route) => route.abort());
    await page.fill('#time-slider', '60');
    await hasText(
      page,
      '#time-message',
      /^Offline: the server does not answer; the map stays as it is\. Trying again\.$/,
    );
    await page.unrouteAll();
    await showsScan(page, 60);
  });

  it('shows the progress of a long weave, and cancels it for the present', async () => {
    const cancelled = page.waitForRequest((request) => request.method() === 'DELETE');
    const slow = { id: '00000000000000aa', state: 'weaving', woven: 12, until: { revision: 102, stamp: null } };
    const answer = (status) => ({ status, contentType: 'application/json', body: JSON.stringify(slow) });
    await page.route('**/weave', (route) => route.fulfill(answer(202)));
    await page.route(`**/weave/${slow.id}`, (route) => {
      return route.fulfill(route.request().method() === 'DELETE' ? { status: 204 } : answer(200));
    });
    await page.fill('#time-slider', '100');
    await hasText(page, '#time-message', /^Computing that map/);
    assert.equal(await page.locator('#time-bar progress').evaluate((bar) => bar.value / bar.max), 12 / 102);
    await page.keyboard.press('l');
    await hasText(page, '#time-mode', /^Live$/);
    await hasText(page, '#time-message', /^$/);
    assert.match((await cancelled).url(), /weave\/00000000000000aa$/);
  });

  it('grows with its session, and keeps the selected scan', async () => {
    await seek(page, 50);
    await drive(45);
    await page.waitForFunction(() => document.querySelector('#time-slider').max === '450');
    assert.equal(await valueOf(page), 50);
    await hasText(page, '#time-place', /^scan 50 of 450/);
    await hasText(page, '[data-robot="r1"] .row-detail', /\b50 scans /);
  });

  it('that comes in pages appears when it is complete; until then the progress is shown', async () => {
    const tab = await openTab(page.context(), server.address, complaints, kHash);
    const requested = [];
    let release;
    const held = new Promise((resolve) => {
      release = resolve;
    });
    await tab.route('**/trajectory.geojson?times=true*', async (route) => {
      const since = Number(new URL(route.request().url()).searchParams.get('since'));
      if (requested.push(since) === 2) await held;
      const response = await route.fetch();
      const json = await response.json();
      json.revision = Math.min(json.revision, since + 200);
      for (const { properties, geometry } of json.features) {
        const isTold = (_, at) => properties.revisions[at] <= json.revision;
        const { revisions, stamps, yaws } = properties;
        geometry.coordinates = geometry.coordinates.filter(isTold);
        Object.assign(properties, { stamps: stamps.filter(isTold), yaws: yaws.filter(isTold) });
        properties.revisions = revisions.filter(isTold);
      }
      await route.fulfill({ response, json });
    });
    await tab.waitForSelector('[data-robot="r1"]');
    await tab.click('#history-open');
    await hasText(tab, '#time-message', /^Loading the history\u2026 4\d %$/);
    assert.ok(await tab.isDisabled('#time-play'));
    assert.equal(await textOf(tab, '#time-place'), '');
    release();
    await hasText(tab, '#time-place', /^scan 450 of 450/);
    await hasText(tab, '#time-message', /^$/);
    assert.deepEqual(requested, [0, 200, 400]);
    await tab.close();
  });

  it('shows the time of day, and marks gaps', async () => {
    const tab = await openTab(page.context(), server.address, complaints, kHash);
    await tab.route('**/trajectory.geojson?times=true*', async (route) => {
      const response = await route.fetch();
      const json = await response.json();
      for (const { properties } of json.features) {
        const noon = new Date(2026, 4, 3, 12).getTime() / 1000;
        properties.stamps = properties.stamps.map((_, at) => noon + at / 10 + (at < 200 ? 0 : 3_720));
      }
      await route.fulfill({ response, json });
    });
    await openHistory(tab);
    await seek(tab, 201);
    assert.match(await textOf(tab, '#time-place'), /, 13:02:20 \(\+1:02:20\), after 1 h 2 min without scans$/);
    assert.match(await textOf(tab, '#time-note'), /then, .*2026/);
    assert.equal(await tab.locator('.time-marks span').count(), 1);
    await keepPicture(tab, 'time-gap');
    await tab.close();
  });

  it('fits a phone', async () => {
    const phone = await openPage(browser, server.address, { hash: kHash, size: [390, 844], scheme: 'dark' });
    await phone.page.waitForSelector('[data-robot="r1"]', { state: 'attached' });
    await openHistory(phone.page);
    await seek(phone.page, 200);
    const wide = await phone.page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 390, `${wide} pixels wide`);
    for (const control of ['#time-back', '#time-play', '#time-forward', '#time-speed', '#time-live', '#time-close']) {
      const { x, width, height } = await phone.page.locator(control).boundingBox();
      assert.ok(x >= 0 && x + width <= 390 && height >= 40 && width >= 40, `${control} is within reach of a thumb`);
    }
    await keepPicture(phone.page, 'time-phone-dark');
    assert.deepEqual(phone.complaints, []);
    await phone.page.context().close();
  });

  it('ends with its session', async () => {
    await fetch(`${server.address}api/v1/sessions/run`, { method: 'DELETE' });
    await page.waitForSelector('#time-bar', { state: 'hidden' });
    await hasText(page, '#notice', /was deleted/);
    await page.keyboard.press('t');
    assert.ok(await page.isHidden('#time-bar'));
    await drive(10);
    await page.waitForSelector('#notice', { state: 'hidden' });
    await openHistory(page);
    assert.equal(await page.getAttribute('#time-slider', 'max'), '100');
    assert.deepEqual(complaints, []);
  });
});
