/** Robots whose poses the server estimates, with a fake server: what operators say about them, and their session. */
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { violations } from './accessibility.mjs';
import { colourAt, colourOf, hasText, isLike, keepPicture, showsColour, textOf, until } from './browser.mjs';
import { withFakeServer } from './fake_fixture.mjs';
import { FakeSession } from './fake_session.mjs';
import { kMiddle, pixelOf } from './one_tile.mjs';

/** Numbers of the live protocol. */
const kTracking = 1;
const kLost = 2;
const kUnlocated = 3;
const known = (state) => ({ state, poses: 1, inliers: 0.9, sigma_m: 0.02 });

describe('robots whose poses the server estimates', () => {
  let page;
  let server;
  let session;
  const openPage = withFakeServer((fresh) => {
    server = fresh;
    session = server.add(new FakeSession('map', 'id-map'));
    session.paint(256, 255, 0);
  });

  const open = async () => {
    ({ page } = await openPage());
    await showsColour(page, '--cell-free');
  };

  /** Answers requests to this path, and keeps their bodies. */
  const accept = async (path) => {
    const bodies = [];
    await page.route(path, (route) => {
      bodies.push(route.request().postDataJSON());
      return route.fulfill({ status: 202, contentType: 'application/json', body: route.request().postData() });
    });
    return bodies;
  };

  const refuse = (path, detail) =>
    page.route(path, (route) =>
      route.fulfill({
        status: 409,
        contentType: 'application/problem+json',
        body: JSON.stringify({ title: 'Conflict', status: 409, detail }),
      }),
    );

  it('are searched for where an operator says that they are', async () => {
    ['given', 'fine', 'lost', 'new'].forEach((name, n) => session.move(name, 1 + n, 1, 0));
    [undefined, kTracking, kLost, kUnlocated].forEach((state, n) => {
      if (state) session.robots[n].known = known(state);
    });
    await open();
    const locate = (name) => page.locator(`[data-robot="${name}"] .locate`);
    await locate('lost').waitFor({ state: 'visible' });
    assert.ok(await locate('given').isHidden(), 'its poses are not estimated');
    const isProminent = (name) => locate(name).evaluate(({ classList }) => classList.contains('primary'));
    const prominent = await Promise.all(['fine', 'lost', 'new'].map(isProminent));
    assert.deepEqual(prominent, [false, true, true]);

    const bodies = await accept('**/sessions/map/relocalize');
    await page.getByRole('button', { name: 'Locate lost: say where it is' }).click();
    await hasText(page, '#tool-body [role=status]', /^Click the place of lost, or/);
    await page.mouse.move(...pixelOf(6.4, 6.4));
    await showsCircle([6.4, 6.4], 5);
    await page.fill('[name=radius]', '2.5');
    await showsCircle([6.4, 6.4], 2.5);
    await keepPicture(page, 'locate');
    assert.deepEqual(await violations(page), []);
    await page.mouse.click(...pixelOf(8, 6));
    await hasText(page, '#tool-body [role=status]', /^The next scan of lost is searched for within 2\.5 m\.$/);
    assert.equal(bodies.length, 1);
    const [{ near, ...rest }] = bodies;
    assert.deepEqual(rest, { robot: 'lost', radius: 2.5 });
    assert.ok(Math.hypot(near[0] - 8, near[1] - 6) < 0.03, `near ${near}`);
    assert.equal(await page.locator('#map.picking').count(), 0, 'one place is picked');
    await showsCircle([8, 6], 2.5);

    await page.unrouteAll();
    await refuse('**/relocalize', 'robot "lost" sends its poses');
    await page.click('#tool-body :text-is("Choose another place")');
    await page.mouse.click(...pixelOf(3, 3));
    await hasText(page, '#tool-body [role=alert]', /^Conflict: robot "lost" sends its poses\.$/);
    await page.keyboard.press('Escape');
    await page.waitForSelector('#tool', { state: 'hidden' });
    await showsNoCircle([3, 3], 2.5);
    assert.equal(await page.locator('#map.picking').count(), 0);
  });

  it('are searched for at the crosshair of the keyboard', async () => {
    session.move('r1', 1, 1, 0);
    session.robots[0].known = known(kLost);
    await open();
    const bodies = await accept('**/relocalize');
    await page.locator('[data-robot=r1] .locate').focus();
    await page.keyboard.press('Enter');
    await showsCircle([6.4, 6.4], 5);
    await page.keyboard.press('Enter');
    await hasText(page, '#tool-body [role=status]', /^The next scan of r1 is searched for within 5 m\.$/);
    assert.equal(bodies.length, 1);
    assert.deepEqual(
      bodies[0].near.map((metres) => metres.toFixed(2)),
      ['6.40', '6.40'],
    );
  });

  it('share a map that an operator keeps from changing', async () => {
    session.move('r1', 1, 1, 0);
    session.robots[0].known = known(kTracking);
    await open();
    await hasText(page, '#facts', /Mapping$/);
    const bodies = await accept('**/sessions/map/mode');
    await page.click('#mode :text-is("Localize only")');
    await hasText(page, '#facts', /Localize only: the map does not change$/);
    assert.deepEqual(bodies, [{ localize_only: true }]);
    session.localizeOnly = true;

    await page.unrouteAll();
    await refuse('**/mode', 'robot "a" sends its poses and robot "b" does not');
    await page.click('#mode :text-is("Continue mapping")');
    await hasText(page, '#mode [role=alert]', /^Conflict: robot "a" sends its poses and robot "b" does not\.$/);
    await hasText(page, '#facts', /Localize only: the map does not change$/);
    await keepPicture(page, 'localize-only');
    assert.deepEqual(await violations(page), []);

    session.localizeOnly = false; // by another operator
    session.revision += 1;
    await hasText(page, '#facts', /Mapping$/);
    assert.equal(await textOf(page, '#mode button'), 'Localize only');
  });

  it('may have sent odometry as their poses, which is then estimated', async () => {
    session.move('r1', 1, 1, 0);
    await open();
    const bodies = await accept('**/sessions/map/estimate');
    const dialog = page.getByRole('dialog', { name: 'Estimate poses?' });
    await page.click('#estimate :text-is("Estimate poses\u2026")');
    await keepPicture(page, 'estimate');
    assert.deepEqual(await violations(page), []);
    await dialog.getByRole('button', { name: 'Cancel' }).click();
    await dialog.waitFor({ state: 'detached' });
    assert.deepEqual(bodies, []);

    await page.click('#estimate button');
    await dialog.getByRole('button', { name: 'Estimate', exact: true }).click();
    await dialog.waitFor({ state: 'detached' });
    assert.deepEqual(bodies, [{ poses: 'odometry' }]);
    session.robots[0].known = known(kTracking);
    session.move('r1', 2, 1, 0);
    await page.locator('#estimate button').waitFor({ state: 'hidden' });

    delete session.robots[0].known;
    session.move('r1', 3, 1, 0);
    await page.unrouteAll();
    await refuse('**/estimate', 'robot "r1" is connected');
    await page.click('#estimate button');
    await dialog.getByRole('button', { name: 'Estimate', exact: true }).click();
    await hasText(page, 'dialog[open] [role=alert]', /robot "r1" is connected\.$/);
  });

  it('have past maps with poses as believed then, or as known today', async () => {
    for (const x of [1, 2, 3]) session.move('r1', x, 1, 0);
    session.robots[0].known = known(kTracking);
    await open();
    const started = await weave();
    await openHistory();
    await seek(2);
    const [, second] = session.tracks.get('r1');
    assert.deepEqual(started, [{ until: second.revision, poses: 'then' }]);
    await hasText(
      page,
      '#time-note',
      /^Map as it was believed to be then.*; robots and trails at the poses known today;/,
    );
    assert.ok(await page.isHidden('[data-robot=r1] .locate'), 'in the past');

    // Tiles of one revision may differ now, so all are fetched again; until then the old ones stay.
    let release;
    const held = new Promise((resolve) => (release = resolve));
    await page.route(/tiles.*weave=/, async (route) => {
      await held;
      await route.continue().catch(() => {});
    });
    await page.selectOption('#time-poses', 'now');
    await hasText(page, '#time-note', /^Map, robots and trails of that time.*, at the poses known today;/);
    await until(page, () => started.length === 2);
    assert.deepEqual(started[1], { until: second.revision, poses: 'now' });
    await seek(1);
    assert.deepEqual(await colourAt(page, ...kMiddle), await colourOf(page, '--cell-free'));
    await keepPicture(page, 'time-poses');
    assert.deepEqual(await violations(page), []);
    release();
    await until(page, () => server.tileRequests.some((path) => path.includes('weave=3')));
    assert.equal(started.length, 3);
    assert.equal(started[2].poses, 'now');
  });

  it('offer no choice of poses to a session whose robots send theirs', async () => {
    for (const x of [1, 2, 3]) session.move('r1', x, 1, 0);
    await open();
    const started = await weave();
    await openHistory();
    await seek(2);
    assert.ok(await page.isHidden('#time-poses'));
    assert.deepEqual(started, [{ until: session.tracks.get('r1')[1].revision }]);
  });

  /** Completes replay jobs at once, with their number as id, and keeps the bodies of their requests. */
  async function weave() {
    const bodies = [];
    const done = (id) => ({ id, state: 'done', woven: 1, until: { revision: 1 } });
    await page.route('**/weave', (route) => {
      bodies.push(route.request().postDataJSON());
      return route.fulfill({ json: done(String(bodies.length)) });
    });
    await page.route('**/weave/*', (route) => route.fulfill({ json: done(route.request().url().split('/').at(-1)) }));
    return bodies;
  }

  async function openHistory() {
    await page.click('#history-open');
    await page.waitForSelector('#time-slider[max="3"]');
  }

  /** Moves the slider there, and waits until the page shows that moment. */
  async function seek(scan) {
    await page.fill('#time-slider', String(scan));
    await hasText(page, '[data-robot=r1] .row-detail', new RegExp(`\\b${scan} scans? `));
  }

  /** Whether the outline of this circle is drawn at its right end. */
  async function hasCircle([x, y], radius) {
    const accent = await colourOf(page, '--accent');
    const [right, middle] = pixelOf(x + radius, y);
    const seen = await Promise.all([-2, -1, 0, 1, 2].map((dx) => colourAt(page, right + dx, middle)));
    return seen.some((each) => each !== null && isLike(each, accent, 60));
  }

  function showsCircle(middle, radius) {
    return until(page, () => hasCircle(middle, radius));
  }

  function showsNoCircle(middle, radius) {
    return until(page, async () => !(await hasCircle(middle, radius)));
  }
});
