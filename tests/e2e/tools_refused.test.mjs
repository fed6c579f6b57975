/** The tools of the viewer when the server refuses, is slow, or answers incorrectly. */
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { violations } from './accessibility.mjs';
import { colourOf, countsPixels, keepPicture, hasText, showsColour, showsColourAt } from './browser.mjs';
import { withFakeServer } from './fake_fixture.mjs';
import { FakeSession } from './fake_session.mjs';
import { encodeGreyPng } from './png.mjs';

const kHostile = '<img src=x onerror="document.title=1">';
/** Left of the card, on the only tile. */
const kPlaces = [
  [600, 300],
  [700, 500],
];
const kWeaveId = '0123456789abcdef';
const kAreas = {
  ...{ neither: 0, only_a: 1.5, only_b: 2, both_free: 120, both_occupied: 4 },
  ...{ free_occupied: 0.25, occupied_free: 0.5, undecided: 7 },
};

describe('tools that are refused', () => {
  let server;
  let page;
  let session;
  const openPage = withFakeServer(async (fresh) => {
    server = fresh;
    session = server.add(new FakeSession('map', 'id-map'));
    session.paint(256, 255, 10);
    session.move('r1', 1, 1, 0);
    ({ page } = await openPage());
    await showsColour(page, '--cell-free');
  });

  const answer = (path, body, { status = 200, type = 'application/json', headers = {} } = {}) =>
    page.route(path, (route) =>
      route.fulfill({ status, contentType: type, headers, body: Buffer.isBuffer(body) ? body : JSON.stringify(body) }),
    );

  const refuse = (path, status, detail) =>
    answer(
      path,
      { type: 'about:blank', title: 'Refused', status, detail },
      { status, type: 'application/problem+json' },
    );

  const alerted = (pattern) => hasText(page, '#tool-body [role=alert]', pattern);

  const clickBoth = async () => {
    await page.waitForSelector('#map.picking');
    for (const place of kPlaces) await page.mouse.click(...place);
  };

  const pathFeature = (coordinates) => ({
    ...{ type: 'Feature', revision: 1, properties: { length: 1, cost: 1 } },
    geometry: { type: 'LineString', coordinates },
  });

  it('show the server\u2019s message, as text', async () => {
    await refuse('**/plan', 409, `the goal is in ${kHostile}`);
    await page.keyboard.press('p');
    await clickBoth();
    await alerted(/^Refused: the goal is in <img src=x .*>\.$/);
    assert.equal(await page.locator('img').count(), 0);
    assert.deepEqual(await violations(page), []);
  });

  it('draw nothing of an invalid path', async () => {
    for (const coordinates of [
      [
        [1, 'x'],
        [2, 2],
      ],
      [[1, 1]],
      kHostile,
      null,
      [
        [1, 1],
        [Infinity, 0],
      ],
    ]) {
      await page.unrouteAll();
      await answer('**/plan', pathFeature(coordinates));
      await page.keyboard.press('p');
      await clickBoth();
      await alerted(/answer cannot be read/);
      assert.equal(await page.locator('.tool-figures').count(), 0);
      await page.keyboard.press('Escape');
    }
  });

  it('show only the newest plan, in whatever order answers arrive', async () => {
    let requested = 0;
    let come;
    const first = new Promise((resolve) => (come = resolve));
    let release;
    const held = new Promise((resolve) => (release = resolve));
    let late;
    const answered = new Promise((resolve) => (late = resolve));
    await page.route('**/plan', async (route) => {
      requested += 1;
      const length = requested;
      come();
      if (length === 1) await held;
      const found = {
        ...pathFeature([
          [1, 1],
          [2, 2],
        ]),
        properties: { length, cost: 1 },
      };
      await route.fulfill({ contentType: 'application/json', body: JSON.stringify(found) }).catch(() => {});
      if (length === 1) late();
    });
    await page.keyboard.press('p');
    await clickBoth();
    await first; // a request that is cancelled before it is sent never reaches the route
    await page.mouse.click(650, 450);
    await hasText(page, '.tool-figures', /2\.00 m/);
    release();
    await answered;
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve))));
    assert.match(await page.textContent('.tool-figures'), /2\.00 m/);
    await page.click('#tool-body :text-is("Plan path")');
    await hasText(page, '.tool-figures', /3\.00 m/);
  });

  it('report that the map has grown, and replan automatically when enabled', async () => {
    let requested = 0;
    await page.route('**/plan', async (route) => {
      requested += 1;
      const body = JSON.stringify({
        ...pathFeature([
          [1, 1],
          [2, 2],
        ]),
        revision: session.revision,
      });
      await route.fulfill({ contentType: 'application/json', body });
    });
    await page.keyboard.press('p');
    await clickBoth();
    await hasText(page, '#tool-body', /Path found/);
    session.move('r1', 2, 2, 0);
    await hasText(page, '#tool-body', /The map has grown since/);
    assert.equal(requested, 1);
    await page.check('[name=keep_up]');
    await hasText(page, '#tool-body', /Path found/);
    session.move('r1', 3, 2, 0);
    await page.waitForRequest('**/plan');
  });

  it('show why there is no coverage, no file and no weave', async () => {
    await refuse('**/coverage', 409, 'the start is in a wall');
    await refuse('**/map.png*', 413, 'this map has 20000 x 20000 pixels');
    await refuse('**/log*', 409, 'the log is damaged');
    await page.route('**/weave', (route) => {
      const problem = { title: 'Refused', detail: 'p_free is too much' };
      if (route.request().method() === 'POST') return route.fulfill({ status: 400, body: JSON.stringify(problem) });
      return route.fulfill({ contentType: 'application/json', body: JSON.stringify({ weaves: [] }) });
    });
    await page.keyboard.press('c');
    await page.click('#tool-body :text-is("Plan path")');
    await alerted(/the start is in a wall\.$/);
    await page.keyboard.press('Escape');
    await page.keyboard.press('e');
    await page.click('#tool-body :text-is("PNG")');
    await alerted(/this map has 20000 x 20000 pixels\.$/);
    await page.click('#tool-body :text-is("CARMEN log")');
    await alerted(/the log is damaged\.$/);
    await page.keyboard.press('Escape');
    await page.keyboard.press('w');
    await page.click('#tool-body :text-is("Weave")');
    await alerted(/p_free is too much\.$/);
  });

  it('show weaves whose settings are hostile as text, and their difference in numbers and as a picture', async () => {
    const config = { cell_size: 0.05, [kHostile]: kHostile };
    const weave = { id: kWeaveId, state: 'done', revision: 2, woven: 2, until: { revision: 2 }, follows: true, config };
    await answer('**/weave', { weaves: [weave] });
    await answer('**/difference?*', { areas: kAreas, agreement: 0.925, mean_difference: null });
    const grey = encodeGreyPng(2, 2, new Uint8Array(4).fill(90));
    const bounds = { 'Scanloom-Bounds': '0,0,12.8,12.8' };
    await answer('**/difference.png?*', grey, { type: 'image/png', headers: bounds });
    await page.keyboard.press('w');
    await hasText(page, '.tool-weaves', /<img src=x/);
    await page.click('.tool-weaves :text-is("Show")');
    await page.waitForSelector('.tool-weaves [aria-pressed=true]');
    await hasText(page, '.tool-difference', /Agreement.*92\.5 %.*obstacle only in the map.*0\.50 m/);
    await page.check('[name=difference]');
    await showsColourAt(page, kPlaces[0], [90, 90, 90]);
    await keepPicture(page, 'tool-difference');
    assert.deepEqual(await violations(page), []);
    await page.uncheck('[name=difference]');
    await showsColourAt(page, kPlaces[0], [90, 90, 90], false);
    await page.click('#tool-body :text-is("End the comparison")');
    await page.waitForSelector('.tool-difference', { state: 'hidden' });
    assert.equal(await page.locator('img').count(), 0);
  });

  it('show the progress of a weave, and cancel it', async () => {
    const config = { cell_size: 0.05 };
    const weave = {
      id: kWeaveId,
      state: 'weaving',
      revision: null,
      woven: 3,
      until: { revision: 9 },
      follows: true,
      config,
    };
    const deleted = [];
    let there = [];
    await page.route('**/weave', (route) => {
      if (route.request().method() === 'POST') there = [weave];
      const body = route.request().method() === 'POST' ? weave : { weaves: there };
      return route.fulfill({ contentType: 'application/json', body: JSON.stringify(body) });
    });
    await page.route('**/weave/*', (route) => {
      deleted.push(route.request().method());
      there = [];
      return route.fulfill({ status: 204 });
    });
    await page.keyboard.press('w');
    await page.click('#tool-body :text-is("Weave")');
    await hasText(page, '.tool-weaves', /3 of 9 entries/);
    assert.equal(await page.locator('.tool-weaves progress').evaluate(({ position }) => position.toFixed(2)), '0.33');
    await page.click('.tool-weaves :text-is("Cancel")');
    await hasText(page, '#tool-body [role=status]', /Cancelled/);
    await page.waitForSelector('.tool-weaves li', { state: 'detached' });
    assert.deepEqual(deleted, ['DELETE']);
  });

  it('remove their drawings and abort their requests when they are closed', async () => {
    await answer(
      '**/plan',
      pathFeature([
        [1, 1],
        [9, 9],
      ]),
    );
    await page.keyboard.press('p');
    await clickBoth();
    await hasText(page, '#tool-body', /Path found/);
    await showsColour(page, '--path');
    await page.keyboard.press('Escape');
    await page.waitForSelector('#tool', { state: 'hidden' });
    assert.equal(await page.locator('#tool-body > *').count(), 0);
    await countsPixels(page, await colourOf(page, '--path'), (pixels) => pixels === 0);
    assert.equal(await page.locator('#map.picking').count(), 0);
  });

  it('are hidden without a map, except the import', async () => {
    server.sessions.clear();
    await hasText(page, '#notice', /deleted/);
    await page.keyboard.press('p');
    assert.ok(await page.locator('#tool').isHidden());
    await page.keyboard.press('i');
    await page.waitForSelector('#tool[data-tool=import]', { state: 'visible' });
  });
});
