/** The viewer with a fake server. */
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import {
  colourOf,
  colourScheme,
  countPixels,
  countsPixels,
  keepPicture,
  hasText,
  showsColour,
  textOf,
} from './browser.mjs';
import { withFakeServer } from './fake_fixture.mjs';
import { FakeSession } from './fake_session.mjs';

const kHostile = '<img src=x onerror="document.title=1">';

describe('the viewer', () => {
  let server;
  let page;
  let complaints = [];
  const openPage = withFakeServer((fresh) => (server = fresh));

  const open = async (options) => ({ page, complaints } = await openPage(options));

  it('shows how to start a session, and opens the first one automatically', async () => {
    await open();
    await hasText(page, '#notice', /No sessions yet.*scanloom-robot --server 127\.0\.0\.1:17447/s);
    await keepPicture(page, 'no-sessions');
    painted('first');
    await hasText(page, '#sessions', /first/);
    await page.waitForSelector('#notice', { state: 'hidden' });
    assert.equal(new URL(page.url()).hash, '#session=first');
  });

  it('shows the robots\u2019 address when it differs from the page\u2019s', async () => {
    server.robots = { host: '192.0.2.7', port: 7448 };
    await open();
    await hasText(page, '#notice', /scanloom-robot --server 192\.0\.2\.7:7448/);
  });

  it('marks a damaged session, and shows the others', async () => {
    server.damaged.push({ name: 'broken', reason: 'entry 7 of its log is damaged' });
    painted('whole');
    await open();
    await hasText(page, '#damaged', /broken.*not served.*entry 7 of its log/s);
    await hasText(page, '#sessions', /whole/);
    await page.waitForSelector('#notice', { state: 'hidden' });
    await page.goto(`${server.address}#session=broken`);
    await hasText(page, '#notice', /Session not served.*entry 7 of its log/s);
    complaints.splice(0); // reported by the browser: the 500 is expected
  });

  it('shows the map of a session that accepts no scans, and says so', async () => {
    const session = painted('full-disk');
    await open();
    await hasText(page, '#sessions', /full-disk/);
    await page.waitForSelector('#sessions .damaged', { state: 'hidden' });
    session.failure = 'no space left on the disk';
    await page.waitForSelector('#sessions .damaged', { state: 'visible' });
    await hasText(page, '#sessions', /full-disk.*accepts no scans.*no space left on the disk/);
    await keepPicture(page, 'takes-no-scans');
    await page.waitForSelector('#notice', { state: 'hidden' });
  });

  it('shows the same values of a session in the list and next to the map', async () => {
    const session = painted('map');
    await open();
    await tilesShown();
    await page.evaluate(() => {
      window.pairs = new Set();
      const compare = () => {
        const listed = document.querySelector('#sessions .row-detail')?.textContent.split(' scan')[0];
        window.pairs.add(`${listed} = ${document.querySelector('#facts dd')?.textContent}`);
        requestAnimationFrame(compare);
      };
      compare();
    });
    for (const scans of [1, 2, 3]) {
      session.move('r1', scans, 1, 0);
      await page.waitForFunction((pair) => window.pairs.has(pair), `${scans} = ${scans}`);
    }
    assert.deepEqual(await page.evaluate(() => [...window.pairs]), ['0 = 0', '1 = 1', '2 = 2', '3 = 3']);
  });

  it('keeps the chosen session in the address, over a reload', async () => {
    painted('one');
    painted('two');
    await open();
    await page.click('#sessions a:has-text("two")');
    await page.waitForFunction(() => document.title.startsWith('two'));
    await page.reload();
    await page.waitForSelector('#sessions a[aria-current]:has-text("two")');
    await page.goBack();
    await page.waitForSelector('#sessions a[aria-current]:has-text("one")');
  });

  it('escapes names', async () => {
    const session = painted(kHostile);
    session.move(kHostile, 1, 1, 0);
    await open();
    await hasText(page, '#robots .row-name', /<img/);
    server.failure = { status: 500, title: kHostile, detail: '<b>broken</b>' };
    await hasText(page, '#status', /<b>broken<\/b>/);
    server.failure = null;
    await hasText(page, '#status', /^$/);
    server.sessions.clear();
    await hasText(page, '#notice', /deleted/);
    assert.equal(await page.locator('img, b').count(), 0);
    assert.match(await page.title(), /^<img/);
  });

  it('fetches only tiles with data, and again only changed ones', async () => {
    const session = painted('map');
    session.paint(257, 255, 10);
    await open();
    await tilesShown();
    const first = tilePaths();
    assert.equal(first.length, new Set(first).size, 'no tile is fetched twice');
    assert.ok(
      first.every((path) => session.tiles.has(path)),
      'no request for tiles without data',
    );
    server.tileRequests.length = 0;
    session.paint(257, 255, 90);
    await occupiedShown();
    const again = tilePaths();
    assert.deepEqual(again, [again.find((path) => path.endsWith('/257/255')) ?? again[0]]);
    assert.match(server.tileRequests[0], new RegExp(`\\?v=${session.revision}&`));
  });

  it('shows no blank frame while tiles change', async () => {
    const session = painted('map');
    await open();
    await tilesShown();
    await page.evaluate(() => {
      window.emptiest = Infinity;
      window.frames = 0;
      const look = () => {
        const canvas = document.querySelector('#map canvas');
        const { data } = canvas.getContext('2d').getImageData(canvas.width / 2, canvas.height / 2, 40, 40);
        let drawn = 0;
        for (let at = 3; at < data.length; at += 4) drawn += data[at] > 0 ? 1 : 0;
        window.emptiest = Math.min(window.emptiest, drawn);
        window.frames += 1;
        requestAnimationFrame(look);
      };
      look();
    });
    for (let round = 0; round < 6; ++round) {
      session.paint(256, 255, 10 + round);
      const version = `.png?v=${session.revision}&`;
      await page.waitForResponse((response) => response.url().includes(version));
      const seen = await page.evaluate(() => window.frames);
      await page.waitForFunction((least) => window.frames >= least, seen + 5); // changes continue meanwhile
    }
    const { emptiest, frames } = await page.evaluate(() => ({ emptiest: window.emptiest, frames: window.frames }));
    assert.ok(frames > 30, `only ${frames} frames were checked`);
    assert.equal(emptiest, 1600);
  });

  it('shows position, cell and value under the pointer', async () => {
    painted('map', 83);
    await open();
    await tilesShown();
    await page.hover('#map');
    await hasText(page, '#cursor-value', /^83 % occupied$/);
    const [x, y] = await Promise.all(['#cursor-x', '#cursor-y'].map(async (id) => Number(await textOf(page, id))));
    const [i, j] = (await textOf(page, '#cursor-cell')).split(', ').map(Number);
    // The one tile extends 12.8 m from the origin up and right, and is fitted in the middle of the map.
    assert.ok(Math.abs(x - 6.4) < 0.2 && Math.abs(y - 6.4) < 0.2, `${x}, ${y}`);
    assert.ok(Math.abs(x / 0.05 - i) <= 1.2 && Math.abs(y / 0.05 - j) <= 1.2, `${i}, ${j}`);
    await page.mouse.move(310, 400);
    await hasText(page, '#cursor-value', /^unknown$/);
  });

  it('works with the keyboard alone', async () => {
    painted('one', 40);
    await open();
    await tilesShown();
    for (let step = 0; step < 12; ++step) {
      await page.keyboard.press('Tab');
      if (await page.evaluate(() => document.activeElement.id === 'map')) break;
    }
    await page.waitForSelector('#crosshair:not([hidden])');
    await hasText(page, '#cursor-value', /^40 % occupied$/);
    const before = await textOf(page, '#cursor-x');
    await page.keyboard.press('ArrowRight');
    await page.waitForFunction((old) => document.querySelector('#cursor-x').textContent !== old, before);
  });

  it('reports that it is offline, and recovers automatically', async () => {
    const session = painted('map');
    for (const scan of [1, 2, 3]) session.move('r1', scan, 1, 0);
    session.move('r2', 1, 1, 0);
    session.robots[1].connected = false;
    await open();
    await tilesShown();
    session.move('r1', 4, 1, 0);
    await hasText(page, '#sessions', /online.*scans\/s.*1 of 2 online/);
    await hasText(page, '[data-robot="r1"]', /online/);
    await hasText(page, '[data-robot="r2"]', /offline/);
    await page.click('#history-open');
    await hasText(page, '#time-mode', /^Live$/);
    const filled = await countPixels(page, await colourOf(page, '--robot-0'));
    await server.vanish();
    await hasText(page, '#status', /Offline/);
    await hasText(page, '#time-mode', /^Offline$/);
    await page.waitForSelector('#time-live[aria-pressed=false]');
    await countsPixels(page, await colourOf(page, '--robot-0'), (count) => count > 0 && count < filled / 2);
    await hasText(page, '#robots', /unknown.*unknown/);
    // Online states and rates are hidden while they are unknown.
    assert.equal(await page.isVisible('#sessions .online'), false);
    for (const part of ['#sessions .row-detail', '#robots']) {
      for (const text of await page.locator(part).allTextContents())
        assert.doesNotMatch(text, /online|offline|scans\/s/);
    }
    assert.ok((await countPixels(page, await colourOf(page, '--cell-free'))) > 0, 'the map stays');
    await keepPicture(page, 'offline');
    session.paint(256, 255, 100);
    await server.comeBack();
    await hasText(page, '#status', /Online again/);
    await occupiedShown();
    await hasText(page, '#status', /^$/);
    await hasText(page, '[data-robot="r1"]', /online/);
    await hasText(page, '#time-mode', /^Live$/);
  });

  it('shows an error\u2019s message, and continues when it is over', async () => {
    painted('map');
    server.failure = { status: 503, title: 'Store not open', detail: 'recovering' };
    await open();
    await hasText(page, '#status', /Store not open: recovering/);
    server.failure = null;
    await tilesShown();
    await hasText(page, '#status', /^$/);
  });

  it('reports that a session was deleted, and shows a recreated one from the start', async () => {
    const session = painted('map', 0);
    session.move('r1', 1, 1, 0);
    await open();
    await tilesShown();
    server.sessions.delete('map');
    await hasText(page, '#notice', /was deleted/);
    await keepPicture(page, 'deleted');
    painted('map', 100, 'another-id');
    await occupiedShown();
    await page.waitForSelector('#notice', { state: 'hidden' });
    assert.equal(await page.locator('[data-robot]').count(), 0, 'the old robot has disappeared');
    // Recreated between two polls, with as many revisions as before: only the id differs.
    painted('map', 0, 'a-third-id');
    await freeShown();
  });

  it('waits for a session that does not exist yet', async () => {
    painted('other');
    await open({ hash: '#session=later' });
    await hasText(page, '#notice', /no session later/);
    painted('later');
    await tilesShown();
  });

  it('shows the travelled distance as soon as the trail is drawn', async () => {
    const session = painted('map');
    session.move('r1', 2, 2, 0);
    session.move('r1', 5, 6, 0);
    await open();
    await hasText(page, '[data-robot="r1"] .row-detail', /5\.0 m/);
    assert.equal(countOf('/api/v1/sessions/map'), 1, 'without another request for the session');
  });

  it('follows a robot until the user moves the map', async () => {
    const session = painted('map');
    session.move('r1', 2, 2, 0);
    await open();
    await page.click('.follow');
    await page.focus('#map');
    session.move('r1', 3, 4, 0);
    await page.click('.follow[aria-pressed="true"]', { trial: true });
    await page.waitForFunction(() => /x 3\.00, y 4\.00/.test(document.querySelector('[data-role=pose]').textContent));
    await page.mouse.move(700, 400);
    await hasText(page, '#cursor-x', /\d/);
    await page.mouse.down();
    await page.mouse.move(740, 420, { steps: 4 });
    await page.mouse.up();
    await page.waitForSelector('.follow[aria-pressed="false"]');
  });

  it('fits the whole map on a click, even while it follows a robot', async () => {
    const session = painted('map');
    session.move('r1', 2, 2, 0);
    await open();
    await page.click('.follow');
    // The click comes when the robot moves and the view's animation has just started.
    await page.evaluate(() => {
      const pose = document.querySelector('[data-role=pose]');
      const observer = new MutationObserver(() => {
        observer.disconnect();
        document.querySelector('#fit').click();
      });
      observer.observe(pose, { childList: true });
    });
    session.move('r1', 3, 11, 0);
    await page.waitForSelector('.follow[aria-pressed="false"]');
    // 12.8 m fill the height except for 56 pixels on either side: 1.86 m are 100 pixels from the middle.
    await page.mouse.move(884, 400);
    await hasText(page, '#cursor-x', /^8\.2\d$/);
    await hasText(page, '#cursor-y', /^6\.[34]\d$/);
  });

  it('fits the main part of the map, not a distant stray scan', async () => {
    const session = painted('map');
    session.mainBounds = session.bounds;
    session.bounds = { min_x: 0, min_y: 0, max_x: 1_000_000, max_y: 1_000_000 };
    await open();
    await page.click('#fit');
    await page.mouse.move(884, 400); // as above
    await hasText(page, '#cursor-x', /^8\.2\d$/);
    await hasText(page, '#cursor-y', /^6\.[34]\d$/);
  });

  it('applies the dark scheme', async () => {
    painted('map', 0);
    await open({ scheme: 'dark' });
    await tilesShown();
    const dark = await colourOf(page, '--cell-free');
    await colourScheme(page, 'light');
    await freeShown();
    assert.notDeepEqual(await colourOf(page, '--cell-free'), dark);
  });

  /** Returns a session with one tile, its lower left corner at the origin. */
  function painted(name, percent = 0, id = `id-${name}`) {
    const session = server.add(new FakeSession(name, id));
    session.paint(256, 255, percent);
    return session;
  }

  function countOf(path) {
    return server.requests.filter((each) => each === path).length;
  }

  function tilePaths() {
    return server.tileRequests
      .filter((path) => path.includes('.png'))
      .map((path) => /occupancy\/(\d+\/\d+\/\d+)\.png/.exec(path)[1]);
  }

  function tilesShown() {
    return showsColour(page, '--cell-free', '--cell-occupied');
  }

  function freeShown() {
    return showsColour(page, '--cell-free');
  }

  function occupiedShown() {
    return showsColour(page, '--cell-occupied');
  }
});
