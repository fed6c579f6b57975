/** Overlays of the map: robots, scans, frontiers, landmarks, goals; with a fake server. */
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { violations } from './accessibility.mjs';
import {
  colourAt,
  colourOf,
  countsPixels,
  isLike,
  keepPicture,
  hasText,
  showsColour,
  showsColourAt,
  textOf,
  until,
} from './browser.mjs';
import { withFakeServer } from './fake_fixture.mjs';
import { FakeSession } from './fake_session.mjs';
import { kMiddle, pixelOf } from './one_tile.mjs';

describe('on the map', () => {
  let server;
  let page;
  let session;
  let complaints = [];
  const openPage = withFakeServer((fresh) => {
    server = fresh;
    session = server.add(new FakeSession('map', 'id-map'));
  });

  const open = async (options) => ({ page, complaints } = await openPage(options));

  it('show the end points of the newest scan, unless switched off', async () => {
    session.paint(256, 255, 0);
    session.scan = [
      [3, 3],
      [9.4, 9.4],
    ];
    session.move('r1', 6, 2, 0);
    await open();
    await showsColour(page, '--cell-free');
    const colour = await colourOf(page, '--robot-0');
    await showsAt(...pixelOf(3, 3), colour);
    await showsAt(...pixelOf(9.4, 9.4), colour);
    await page.uncheck('[data-switch=points]');
    await showsNotAt(...pixelOf(3, 3), colour);
  });

  it('show a robot with the area of its body and its trail, without a wrong pose', async () => {
    session.paint(256, 255, 0);
    for (let x = 2; x <= 10; x += 0.5) {
      session.move('r1', x, 6.4, 0);
      if (x === 6) session.move('r1', x, 12.4, 0);
    }
    session.robots[0].body_radius = 1.5;
    session.move('r1', 10, 6.4, 0);
    await open();
    const colour = await colourOf(page, '--robot-0');
    await showsNear(...pixelOf(10, 7.9), colour);
    const free = await colourOf(page, '--cell-free');
    await showsTrail(pixelOf(4, 6.4), colour, free);
    const [x, y] = pixelOf(6, 9.4);
    for (const dx of [-1, 0, 1]) assert.deepEqual(await colourAt(page, x + dx, y), free, 'no line to the wrong pose');
    await keepPicture(page, 'trail');
    await page.uncheck('[data-switch=trails]');
    await showsAt(...pixelOf(4, 6.4), free);
    await page.uncheck('[data-switch=robots]');
    await showsNoPixels(colour);
  });

  it('show the pose graph when switched on, and how well poses are known', async () => {
    session.paint(256, 255, 0);
    session.move('r1', 6, 2, 0);
    session.robots[0].known = { state: 1, poses: 1, inliers: 0.9, sigma_m: 0.124 };
    const keyframe = (at) => ({ properties: { kind: 'keyframe' }, geometry: { type: 'Point', coordinates: at } });
    session.poseGraph = [keyframe([3, 3]), keyframe([9, 9])];
    const geometry = {
      type: 'LineString',
      coordinates: [
        [3, 3],
        [9, 9],
      ],
    };
    session.poseGraph.push({ properties: { kind: 'loop', is_used: true }, geometry });
    session.movingScans = 17;
    await open();
    await hasText(page, '[data-role=localization]', /^tracking, ±12 cm$/);
    await hasText(page, '#moving-scans', /^17 scans are being moved to corrected poses\.$/);
    await showsColour(page, '--cell-free');
    assert.ok(!server.requests.some((request) => request.endsWith('pose_graph.geojson')));
    await page.check('[data-switch=poseGraph]');
    await showsNear(...pixelOf(3, 3), await colourOf(page, '--ink'));
    await showsTrail(pixelOf(5.1, 6.9), await colourOf(page, '--loop'), await colourOf(page, '--cell-free'));
    await keepPicture(page, 'pose-graph');
    assert.deepEqual(await violations(page), []);
    session.robots[0].known = { state: 2, poses: 1, inliers: 0, sigma_m: 0.124 };
    session.movingScans = 0;
    session.notify();
    await hasText(page, '[data-role=localization]', /^lost: its scans fit no place$/);
    await until(page, async () => !(await page.isVisible('#moving-scans')));
  });

  it('show frontiers as areas with their goals, as soon as they change, and only when switched on', async () => {
    session.paint(256, 255, 0);
    session.frontiers = [frontier([3, 3], [5, 5])];
    await open();
    await showsColour(page, '--cell-free');
    const path = '/api/v1/sessions/map/frontiers.geojson';
    assert.ok(!server.requests.includes(path));
    const colour = await colourOf(page, '--class-frontier');
    await page.check('[data-switch=frontiers]');
    await showsAt(...pixelOf(3, 3), colour);
    session.frontiers = [frontier([9, 9], [8, 5])];
    session.move('r1', 1, 1, 0);
    await showsAt(...pixelOf(9, 9), colour);
    await showsNotAt(...pixelOf(3, 3), colour);
    await keepPicture(page, 'frontiers');
  });

  it('ignore malformed frontiers', async () => {
    session.paint(256, 255, 0);
    session.frontiers = [{ type: 'Feature', geometry: { type: '<b>x</b>', coordinates: 'nonsense' }, properties: {} }];
    await open();
    await page.check('[data-switch=frontiers]');
    await page.waitForResponse(/frontiers\.geojson/);
    session.frontiers = [frontier([3, 3], [5, 5])];
    session.move('r1', 1, 1, 0);
    await showsAt(...pixelOf(3, 3), await colourOf(page, '--class-frontier'));
    assert.equal(await page.locator('#map b').count(), 0);
  });

  it('show landmarks as events report them, when switched on', async () => {
    session.paint(256, 255, 0);
    session.see(0, [3, 3], 2);
    await open();
    await showsColour(page, '--cell-free');
    assert.deepEqual(
      session.subscriptions.filter(({ landmarks }) => landmarks),
      [],
    );
    const colour = await colourOf(page, '--landmark');
    await page.check('[data-switch=landmarks]');
    await showsAt(...pixelOf(3, 3), colour);
    session.see(1, [9, 9], 3);
    await showsAt(...pixelOf(9, 9), colour);
    await showsAt(...pixelOf(3, 3), colour);
    session.see(0, [5, 3], 3);
    await showsAt(...pixelOf(5, 3), colour);
    await showsNotAt(...pixelOf(3, 3), colour);
    await page.mouse.move(...pixelOf(5, 3));
    await hasText(page, '#cursor-others', /^Landmark#0: 0\.31 × 0\.1[23] m, observed 3 times/);
    await page.mouse.move(...pixelOf(5, 5));
    await hasText(page, '#cursor-others', /^(?!.*Landmark)/);
    await keepPicture(page, 'landmarks');
    session.noLandmarks = 'there are more than <b>can be kept</b>';
    session.move('r1', 1, 1, 0);
    await hasText(page, '#status', /there are more than <b>can be kept<\/b>/);
    await showsAt(...pixelOf(5, 3), colour);
    session.noLandmarks = null;
    session.see(2, [9, 3], 2);
    await showsAt(...pixelOf(9, 3), colour);
    await hasText(page, '#status', /^$/);
    await page.uncheck('[data-switch=landmarks]');
    await showsNotAt(...pixelOf(9, 9), colour);
    await until(page, () => session.subscriptions.at(-1).landmarks === false);
    session.see(2, [3, 9], 3);
    await page.check('[data-switch=landmarks]');
    await showsAt(...pixelOf(3, 9), colour);
    await showsNotAt(...pixelOf(9, 3), colour);
  });

  it('show fewer landmarks at coarse zooms, and explain the symbols', async () => {
    session.paint(256, 255, 0);
    // 21 along a line of 8 m, the middle one with the most observations, and one with a single observation.
    for (let n = 0; n <= 20; ++n) session.see(n, [2.4 + 0.4 * n, 6.4], n === 10 ? 9 : 2);
    session.see(30, [6.4, 9.4], 1);
    session.frontiers = [frontier([3, 3], [5, 5])];
    session.frontiers.push(frontier([9, 3], null));
    session.frontiers[1].properties.reachable = false;
    await open({ motion: 'reduce' });
    assert.deepEqual([await shown('frontiers'), await shown('landmarks')], [false, false]);
    for (const key of ['frontiers', 'landmarks']) await page.check(`[data-switch=${key}]`);
    assert.match(await textOf(page, '[data-legend=landmarks]'), /observed repeatedly.*observed once/);
    assert.match(await textOf(page, '[data-legend=frontiers]'), /can be reached.*cannot be reached.*where to stand/);
    const colour = await colourOf(page, '--landmark');
    for (const x of [2.4, 6.4, 10.4]) await showsAt(...pixelOf(x, 6.4), colour);
    const [x, y] = pixelOf(6.4, 9.4);
    await showsNear(x, y - 4, colour);
    await keepPicture(page, 'symbols');
    await page.locator('[data-legend=landmarks]').scrollIntoViewIfNeeded();
    assert.deepEqual(await violations(page), []);
    for (let step = 0; step < 4; ++step) await page.click('#zoom-out');
    // 8 m are 27 pixels wide now: one symbol or two, of 28 pixels each, and not a line of them.
    await countsPixels(page, colour, (count) => count > 0 && count < 80);
    await page.mouse.move(...kMiddle);
    await hasText(page, '#cursor-others', /^Landmark#10: .*observed 9 times/);
    await keepPicture(page, 'symbols-far');
  });

  it('show only the new landmarks after a restart of the server', async () => {
    session.paint(256, 255, 0);
    session.see(0, [3, 3], 2);
    await open();
    const colour = await colourOf(page, '--landmark');
    await page.check('[data-switch=landmarks]');
    await showsAt(...pixelOf(3, 3), colour);
    session.landmarks = [];
    session.see(1, [9, 9], 2);
    for (const viewer of session.viewers)
      viewer.close(1001, 'the server is shutting down; connect again when it is back');
    await showsNotAt(...pixelOf(3, 3), colour);
    await showsAt(...pixelOf(9, 9), colour);
  });

  it('show goals and paths of robots as soon as they change, and remove them', async () => {
    session.paint(256, 255, 0);
    session.move('r1', 1, 1, 0);
    await open();
    await showsColour(page, '--cell-free');
    const path = '/api/v1/sessions/map/goals.geojson';
    const colour = await colourOf(page, '--robot-0');
    session.setGoals([
      feature(
        { role: 'way', robot: 'r1' },
        {
          type: 'LineString',
          coordinates: [
            [1, 1],
            [1, 9],
            [9, 9],
          ],
        },
      ),
      feature({ role: 'goal', robot: 'r1', target: [11, 9] }, { type: 'Point', coordinates: [9, 9] }),
    ]);
    const ring = pixelOf(9, 9);
    await showsNear(ring[0], ring[1] - 7, colour);
    await keepPicture(page, 'goals');
    const requested = server.requests.filter((each) => each === path).length;
    session.move('r1', 1, 2, 0);
    await until(page, async () => (await colourAt(page, ...pixelOf(1, 2))) !== null);
    assert.equal(server.requests.filter((each) => each === path).length, requested, 'unchanged goals are not fetched');
    session.setGoals([]);
    await showsNotAt(ring[0], ring[1] - 7, colour);
    session.setGoals([feature({ role: '<b>', robot: 'r1' }, { type: 'Point', coordinates: 'x' })]);
    await page.waitForResponse(/goals\.geojson/);
    session.setGoals([feature({ role: 'goal', robot: 'r1', target: [5, 3] }, { type: 'Point', coordinates: [3, 3] })]);
    const other = pixelOf(3, 3);
    await showsNear(other[0], other[1] - 7, colour);
    await page.uncheck('[data-switch=goals]');
    await showsNotAt(other[0], other[1] - 7, colour);
  });

  it('report that a robot has explored everything, also with goals switched off', async () => {
    session.paint(256, 255, 0);
    session.move('r1', 1, 1, 0);
    await open();
    const note = page.locator('#explored');
    await page.uncheck('[data-switch=goals]');
    assert.ok(await note.isHidden());
    session.setGoals([], ['<b>r1']);
    await note.waitFor({ state: 'visible' });
    assert.equal(await note.textContent(), '<b>r1 has explored all it can reach.');
    await keepPicture(page, 'explored');
    session.setGoals([]);
    await note.waitFor({ state: 'hidden' });
  });

  it('show a grid, the origin and the axes when switched on, also after a reload', async () => {
    session.paint(256, 255, 0);
    await open();
    await showsColour(page, '--cell-free');
    const [alongX, alongY] = [await colourOf(page, '--axis-x'), await colourOf(page, '--axis-y')];
    const onX = pixelOf(6.4, 0);
    await showsNotAt(...onX, alongX);
    await page.check('[data-switch=grid]');
    await showsNear(...onX, alongX);
    // The y axis is on the left edge of the tile.
    const [left, middle] = pixelOf(0, 6.4);
    await until(page, async () => {
      const seen = await Promise.all([-1, 0, 1].map((dx) => colourAt(page, left + dx, middle)));
      return seen.some((each) => each !== null && isLike(each, alongY, 80));
    });
    await showsAt(...pixelOf(0, 0), await colourOf(page, '--ink'));
    await keepPicture(page, 'grid');
    await page.reload();
    await showsNear(...onX, alongX);
    await page.uncheck('[data-switch=grid]');
    await showsNotAt(...onX, alongX);
  });

  it('start with a layer that has data', async () => {
    session.layers = ['sonar'];
    session.paint(256, 255, 100);
    session.move('r1', 1, 1, 0);
    await open();
    await page.waitForSelector('[name=layer][value=sonar]:checked');
    await showsColour(page, '--cell-occupied');
  });

  /** Returns a square of 1 m around a place. */
  function frontier([x, y], goal) {
    const ring = [
      [-0.5, -0.5],
      [0.5, -0.5],
      [0.5, 0.5],
      [-0.5, 0.5],
      [-0.5, -0.5],
    ].map(([dx, dy]) => [x + dx, y + dy]);
    return {
      type: 'Feature',
      properties: { cells: 400, area: 1, centroid: [x, y], reachable: true, robot: 'r1', goal, length: 1, cost: 1 },
      geometry: { type: 'MultiPolygon', coordinates: [[ring]] },
    };
  }

  function feature(properties, geometry) {
    return { type: 'Feature', properties, geometry };
  }

  function shown(legend) {
    return page.isVisible(`[data-legend=${legend}]`);
  }

  function showsAt(x, y, colour) {
    return showsColourAt(page, [x, y], colour);
  }

  function showsNotAt(x, y, colour) {
    return showsColourAt(page, [x, y], colour, false);
  }

  /** Lines are thin: they may share a pixel with the cell below. */
  async function showsNear(x, y, colour) {
    const steps = [-2, -1, 0, 1, 2];
    await until(page, async () => {
      const seen = await Promise.all(steps.map((dy) => colourAt(page, x, y + dy)));
      return seen.some((each) => each !== null && isLike(each, colour, 80));
    });
  }

  /** Waits for the trail there: its colour, mixed with the colour below it. */
  function showsTrail([x, y], trail, below) {
    const steps = [-1, 0, 1];
    return until(page, async () => {
      const seen = await Promise.all(steps.map((dy) => colourAt(page, x, y + dy)));
      const shares = seen.map((each) => (below[0] - (each?.[0] ?? below[0])) / (below[0] - trail[0]));
      return Math.max(...shares) > 0.3 && Math.max(...shares) < 0.65;
    });
  }

  function showsNoPixels(colour) {
    return countsPixels(page, colour, (count) => count === 0);
  }
});
