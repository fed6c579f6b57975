/** Layers, what lies on them, and how they are shown, against a server that does what each test wants. */
import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, describe, it } from 'node:test';
import { violations } from './accessibility.mjs';
import {
  colourAt,
  colourOf,
  countPixels,
  countsPixels,
  isLike,
  keepPicture,
  kWebDirectory,
  launchBrowser,
  openPage,
  says,
  showsColour,
  showsColourAt,
  textOf,
  until,
} from './browser.mjs';
import { FakeServer } from './fake_server.mjs';
import { FakeSession } from './fake_session.mjs';

const kLayers = ['occupancy', 'classification', 'himm', 'sonar'];
/** Of the one tile: 12.8 m from the origin up and right, fitted in the middle of the map. */
const kMiddle = [784, 400];

describe('layers', { timeout: 180_000 }, () => {
  let browser;
  let server;
  let page;
  let session;
  let complaints = [];

  const open = async (options) => ({ page, complaints } = await openPage(browser, server.address, options));

  before(async () => (browser = await launchBrowser()));
  after(() => browser?.close());
  beforeEach(async () => {
    server = await FakeServer.start(kWebDirectory);
    session = server.add(new FakeSession('map', 'id-map'));
    session.layers = kLayers;
  });
  afterEach(async () => {
    await page?.context().close();
    await server.vanish().catch(() => {});
    assert.deepEqual(complaints, []);
  });

  it('are stepped through by keys, each in its colours, and kept in the address', async () => {
    session.paint(256, 255, 4); // danger, counter 4, 4 %
    await open();
    await showsColour(page, '--cell-free');
    await page.keyboard.press('v');
    await showsColour(page, '--class-danger');
    assert.match(page.url(), /layer=classification/);
    await says(page, '#legend', /danger/);
    await page.keyboard.press('v');
    await page.waitForSelector('[name=layer][value=himm]:checked');
    await says(page, '#legend', /counter 0/);
    await page.keyboard.press('b');
    await page.keyboard.press('b');
    await showsColour(page, '--cell-free');
    await page.keyboard.press('b');
    await page.waitForSelector('[name=layer][value=sonar]:checked');
    await page.reload();
    await page.waitForSelector('[name=layer][value=sonar]:checked');
  });

  it('change by key also while a choice of layers has the focus, but not while text is written', async () => {
    session.paint(256, 255, 4);
    await open();
    await showsColour(page, '--cell-free');
    await page.focus('[name=layer][value=occupancy]');
    await page.keyboard.press('v');
    await page.waitForSelector('[name=layer][value=classification]:checked');
    await page.focus('#beside');
    await page.keyboard.press('v');
    await page.waitForSelector('[name=layer][value=classification]:checked');
  });

  it('never ask for tiles of a layer that is not shown', async () => {
    session.paint(256, 255, 4);
    await open();
    await showsColour(page, '--cell-free');
    assert.ok(server.tileRequests.every((path) => path.includes('/occupancy/')), server.tileRequests.join('\n'));
    await page.keyboard.press('v');
    await showsColour(page, '--class-danger');
    const before = server.tileRequests.length;
    session.paint(256, 255, 3);
    await showsColour(page, '--class-frontier');
    const changed = server.tileRequests.slice(before);
    assert.ok(changed.every((path) => path.includes('/classification/')), changed.join('\n'));
  });

  it('show HIMM counters in their cells when zoomed in and asked', async () => {
    session.paint(256, 255, 12);
    await open({ hash: '#session=map&layer=himm' });
    await page.waitForSelector('#notice', { state: 'hidden' });
    await page.keyboard.press('g');
    await page.waitForSelector('[data-switch=counters]:checked');
    const label = [255, 255, 255]; // on a dark counter
    await page.mouse.move(...kMiddle);
    assert.equal(await countPixels(page, label), 0, 'cells are too small for numbers');
    await page.emulateMedia({ reducedMotion: 'reduce' }); // each step at once
    for (let step = 0; step < 7; ++step) await page.click('#zoom-in');
    await page.mouse.move(...kMiddle);
    await countsPixels(page, label, (count) => count > 200);
    assert.match(await textOf(page, '#cursor-value'), /^counter 12$/);
    await keepPicture(page, 'counters');
    await page.keyboard.press('g');
    await page.waitForSelector('[data-switch=counters]:not(:checked)');
    await showsNoPixels(label);
  });

  it('are seen side by side, with a line that pointer and keys move', async () => {
    session.paint(256, 255, 4);
    await open();
    await showsColour(page, '--cell-free');
    await page.selectOption('#beside', 'classification');
    await showsColour(page, '--class-danger');
    const danger = await colourOf(page, '--class-danger');
    assert.deepEqual(await colourAt(page, kMiddle[0] + 60, kMiddle[1]), danger);
    assert.notDeepEqual(await colourAt(page, kMiddle[0] - 60, kMiddle[1]), danger);
    await keepPicture(page, 'swipe');
    await page.mouse.move(...kMiddle);
    await page.mouse.down();
    await page.mouse.move(kMiddle[0] - 150, kMiddle[1], { steps: 3 });
    await page.mouse.up();
    await showsAt(kMiddle[0] - 60, kMiddle[1], danger);
    await page.focus('#swipe');
    await page.keyboard.press('End');
    assert.equal(await page.getAttribute('#swipe', 'aria-valuenow'), '100');
    await showsNoPixels(danger);
    await page.keyboard.press('Home');
    await showsAt(kMiddle[0] - 150, kMiddle[1], danger);
    // What is told is what is seen.
    await page.hover('#map', { position: { x: 500, y: 300 } });
    await says(page, '#cursor-value', /^danger$/);
    await page.selectOption('#beside', '');
    await page.waitForSelector('#swipe', { state: 'hidden' });
    await showsNoPixels(danger);
  });

  it('lie on each other, the second as faint as it is wished', async () => {
    session.paint(256, 255, 4);
    await open();
    await showsColour(page, '--cell-free');
    await page.selectOption('#beside', 'classification');
    await page.check('#mode-over');
    await setRange('#beside-opacity', 100);
    await showsAt(...kMiddle, await colourOf(page, '--class-danger'));
    await setRange('#beside-opacity', 0);
    await showsNoPixels(await colourOf(page, '--class-danger'));
    const full = await colourAt(page, ...kMiddle);
    await setRange('#opacity', 20);
    await page.waitForFunction(() => {
      const { data } = document.querySelector('#map canvas').getContext('2d').getImageData(400, 400, 1, 1);
      return data[3] > 0 && data[3] < 80;
    });
    assert.notEqual(full, null);
  });

  it('tell all that is known of a cell', async () => {
    session.paint(256, 255, 3);
    await open();
    await showsColour(page, '--cell-free');
    await page.mouse.move(...kMiddle);
    await says(page, '#cursor-value', /^3 % occupied$/);
    await says(page, '#cursor-others', /Classesfrontier.*HIMMcounter 3.*Sonar3 % occupied/);
  });

  it('show the newest scan where its beams ended, unless it is not wanted', async () => {
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

  it('show a robot with the ground that its body takes, and its trail', async () => {
    session.paint(256, 255, 0);
    session.move('r1', 2, 6.4, 0);
    session.move('r1', 10, 6.4, 0);
    session.robots[0].body_radius = 1.5;
    session.move('r1', 10, 6.4, 0);
    await open();
    const colour = await colourOf(page, '--robot-0');
    await showsNear(...pixelOf(10, 7.9), colour);
    await showsNear(...pixelOf(4, 6.4), colour);
    await page.uncheck('[data-switch=trails]');
    await showsNotAt(...pixelOf(4, 6.4), colour);
    await page.uncheck('[data-switch=robots]');
    await showsNoPixels(colour);
  });

  it('show frontiers as areas with their goals, as soon as they change, and only when wanted', async () => {
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

  it('survive frontiers that are none', async () => {
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

  it('are measured by pointer and by keys', async () => {
    session.paint(256, 255, 0);
    await open();
    await showsColour(page, '--cell-free');
    await page.keyboard.press('m');
    await page.mouse.click(...pixelOf(2, 2));
    await page.mouse.click(...pixelOf(5, 6));
    await says(page, '#measured', /^(4\.9\d|5\.0\d) m$/);
    await page.mouse.click(...pixelOf(5, 8));
    await says(page, '#measured', /^(6\.9\d|7\.0\d) m$/);
    assert.deepEqual(await violations(page), []);
    await page.click('text=Start again');
    await says(page, '#measured', /^$/);
    await page.focus('#map');
    await page.keyboard.press('Enter');
    const before = await textOf(page, '#cursor-x');
    await page.keyboard.press('ArrowRight');
    await page.waitForFunction((old) => document.querySelector('#cursor-x').textContent !== old, before);
    await page.keyboard.press('Enter');
    await says(page, '#measured', /^\d+\.\d\d m$/);
    await page.keyboard.press('Escape');
    await page.waitForSelector('#tool', { state: 'hidden' });
  });

  it('keep the colours that a person chose, also those for any colour vision', async () => {
    session.paint(256, 255, 3);
    await open({ hash: '#session=map&layer=classification' });
    await showsColour(page, '--class-frontier');
    const standard = await colourOf(page, '--class-frontier');
    await page.selectOption('#palette', 'safe');
    await page.selectOption('#scheme', 'dark');
    const safe = await colourOf(page, '--class-frontier');
    assert.notDeepEqual(safe, standard);
    await showsColour(page, '--class-frontier');
    await page.reload();
    await showsColour(page, '--class-frontier');
    assert.deepEqual(await colourOf(page, '--class-frontier'), safe);
    assert.equal(await page.inputValue('#scheme'), 'dark');
    assert.deepEqual(await violations(page), []);
  });

  for (const [scheme, size] of [
    ['light', [1280, 800]],
    ['dark', [1280, 800]],
    ['light', [390, 844]],
    ['dark', [390, 844]],
  ]) {
    it(`leave nothing for axe-core to find: ${scheme}, ${size.join(' x ')}`, async () => {
      session.paint(256, 255, 3);
      session.move('r1', 2, 2, 0);
      await open({ scheme, size });
      await page.waitForSelector('#notice', { state: 'hidden' });
      if (size[0] < 700) await page.click('#panel-toggle');
      await page.selectOption('#beside', 'himm');
      assert.deepEqual(await violations(page), []);
      await page.click('#keys-open');
      assert.deepEqual(await violations(page), []);
      await keepPicture(page, `keys-${scheme}-${size[0]}`);
    });
  }

  /** A square of 1 m around a place. */
  function frontier([x, y], goal) {
    const ring = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5]].map(([dx, dy]) => [x + dx, y + dy]);
    return {
      type: 'Feature',
      properties: { cells: 400, area: 1, centroid: [x, y], reachable: true, robot: 'r1', goal, length: 1, cost: 1 },
      geometry: { type: 'MultiPolygon', coordinates: [[ring]] },
    };
  }

  /** Of the page: the tile's 12.8 m fill the height but for 56 pixels on either side. */
  function pixelOf(x, y) {
    const scale = (800 - 2 * 56) / 12.8;
    return [kMiddle[0] + (x - 6.4) * scale, kMiddle[1] - (y - 6.4) * scale].map(Math.round);
  }

  function showsAt(x, y, colour) {
    return showsColourAt(page, [x, y], colour);
  }

  /** Lines are thin: they may share a pixel with what lies below. */
  async function showsNear(x, y, colour) {
    const steps = [-2, -1, 0, 1, 2];
    await until(page, async () => {
      const seen = await Promise.all(steps.map((dy) => colourAt(page, x, y + dy)));
      return seen.some((each) => each !== null && isLike(each, colour, 80));
    });
  }

  function showsNotAt(x, y, colour) {
    return showsColourAt(page, [x, y], colour, false);
  }

  function showsNoPixels(colour) {
    return countsPixels(page, colour, (count) => count === 0);
  }

  function setRange(selector, value) {
    return page.$eval(
      selector,
      (input, wanted) => {
        input.value = String(wanted);
        input.dispatchEvent(new Event('input', { bubbles: true }));
      },
      value,
    );
  }
});
