/** Layout of the page and the map, on wide screens and on phones, with a fake server. */
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { violations } from './accessibility.mjs';
import { colourOf, keepPicture, hasText, showsColour, textOf, until } from './browser.mjs';
import { withFakeServer } from './fake_fixture.mjs';
import { FakeSession } from './fake_session.mjs';
import { kMiddle } from './one_tile.mjs';

/** Portrait and landscape: a recent phone and a small one. */
const kPhones = [
  [390, 844],
  [844, 390],
  [667, 375],
];

describe('the page', () => {
  let server;
  let page;
  const openPage = withFakeServer((fresh) => (server = fresh));

  const open = async (options) => ({ page } = await openPage(options));

  it('fits a phone in both orientations: all tools and robots are uncovered, the robots are at the top of the panel', async () => {
    const session = painted('map');
    for (const name of ['b', 'c', 'd', 'e', 'f']) painted(name);
    // In two corners of the map.
    session.move('r1', 0.1, 12.7, 1);
    session.move('r2', 12.7, 0.1, 1);
    await open({ size: [390, 844], scale: 2, hash: '#session=map' });
    await showsColour(page, '--cell-free');
    for (const [width, height] of kPhones) {
      await page.setViewportSize({ width, height });
      await page.waitForFunction((wanted) => innerHeight === wanted, height);
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing overflows');
      assert.equal(await page.isVisible('#sessions'), false);
      assert.deepEqual(await outOfReach('.tools button'), []);
      await until(page, async () => (await markerIsFree('--robot-0')) && (await markerIsFree('--robot-1')));
      await page.tap('#tool-measure');
      await hasText(page, '#tool-body', /^Tap the places/);
      await until(page, async () => !(await overlap('#tool', '#map')));
      await page.tap('#tool-close');
      await page.tap('#panel-toggle');
      assert.equal(await page.isVisible('#sessions'), true);
      await isInView('[data-robot="r1"] [data-role=pose]');
      assert.deepEqual(await violations(page), [], `${width} x ${height}`);
      await keepPicture(page, `phone-${width}`);
      await page.tap('#panel-toggle');
    }
    await page.tap('#map');
    await hasText(page, '#cursor-value', /% occupied/);
  });

  it('shows the robots without scrolling, and a card that can be dragged off a covered place', async () => {
    for (const name of ['a', 'b', 'c', 'd', 'e', 'f', 'g']) painted(name).move('r1', 6, 6, 1);
    await open({ size: [1280, 720], hash: '#session=g' });
    await showsColour(page, '--cell-free');
    await isInView('[data-robot="r1"] [data-role=pose]');
    const [chosen, list] = await boxes('#sessions [aria-current]', '#sessions');
    assert.ok(chosen.y >= list.y && chosen.y < list.y + list.height, 'the open session is in view in the list');
    await page.click('#tool-path');
    await hasText(page, '#tool-body', /^Click the start of the path, or /);
    const before = await page.locator('#tool').boundingBox();
    await drag('#tool-title', -400, 30);
    const after = await page.locator('#tool').boundingBox();
    assert.deepEqual([after.x, after.y], [before.x - 400, before.y + 30]);
    // The card stays on the map, so that no button is cut off.
    await drag('#tool-title', -900, 700);
    const [card, map] = await boxes('#tool', '#map');
    assert.ok(card.x >= map.x && card.y + card.height <= map.y + map.height, JSON.stringify(card));
    await page.setViewportSize({ width: 1280, height: 520 });
    await page.locator('#tool button.primary').click({ trial: true });
    await until(page, async () => {
      const [small, stage] = await boxes('#tool', '#map');
      return small.y >= stage.y && small.y + small.height <= stage.y + stage.height;
    });
  });

  it('keeps the growing map in view until the user moves it, and again after Fit', async () => {
    const session = painted('map');
    await open({ motion: 'reduce' });
    await showsColour(page, '--cell-free');
    await page.mouse.move(...kMiddle);
    await hasText(page, '#cursor-x', /^6\.[34]\d$/);
    for (const column of [257, 258]) session.paint(column, 255, 0);
    await hasText(page, '#cursor-x', /^19\.[12]\d$/);
    await page.mouse.down();
    await page.mouse.move(kMiddle[0] + 60, kMiddle[1], { steps: 4 });
    await page.mouse.up();
    const moved = await textOf(page, '#cursor-x');
    for (const column of [259, 260, 261]) session.paint(column, 255, 0);
    await hasText(page, '#sessions', /76\.8 × 12\.8 m/);
    assert.equal(await textOf(page, '#cursor-x'), moved, 'the view does not change');
    await page.click('#fit');
    await page.mouse.move(...kMiddle);
    await hasText(page, '#cursor-x', /^38\.[34]\d$/);
    session.paint(262, 255, 0);
    await hasText(page, '#cursor-x', /^44\.[78]\d$/);
  });

  /** Returns a session with one tile, its lower left corner at the origin. */
  function painted(name) {
    const session = server.add(new FakeSession(name, `id-${name}`));
    session.paint(256, 255, 0);
    return session;
  }

  /** Whether the robot of this colour is drawn where no control covers it. */
  async function markerIsFree(name) {
    return page.evaluate(
      (colour) => {
        for (const canvas of document.querySelectorAll('#map canvas')) {
          const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
          const found = [];
          for (let at = 0; at < data.length; at += 4) {
            if (data[at + 3] > 200 && colour.every((part, band) => Math.abs(data[at + band] - part) < 12))
              found.push(at / 4);
          }
          if (found.length < 20) continue;
          const { left, top, width } = canvas.getBoundingClientRect();
          const scale = width / canvas.width;
          return found.every((pixel) => {
            const [x, y] = [(pixel % canvas.width) * scale, Math.floor(pixel / canvas.width) * scale];
            return document.elementFromPoint(left + x, top + y)?.closest('#map');
          });
        }
        return false;
      },
      await colourOf(page, name),
    );
  }

  /** Returns the names of buttons whose centre is outside the window or covered. */
  function outOfReach(selector) {
    return page.$$eval(selector, (elements) =>
      elements
        .filter((element) => {
          const { left, right, top, bottom } = element.getBoundingClientRect();
          return !element.contains(document.elementFromPoint((left + right) / 2, (top + bottom) / 2));
        })
        .map((element) => element.id),
    );
  }

  function boxes(...selectors) {
    return Promise.all(selectors.map((selector) => page.locator(selector).boundingBox()));
  }

  async function overlap(one, other) {
    const [a, b] = await boxes(one, other);
    return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
  }

  /** Asserts that neither the panel nor the window cuts it off. */
  async function isInView(selector) {
    const [box, body] = await boxes(selector, '#panel-body');
    const { width, height } = page.viewportSize();
    assert.ok(
      box.y >= body.y && box.y + box.height <= Math.min(height, body.y + body.height),
      `${selector} at ${box.y}`,
    );
    assert.ok(box.x >= 0 && box.x + box.width <= width);
  }

  async function drag(selector, dx, dy) {
    const [{ x, y }] = await boxes(selector);
    await page.mouse.move(x + 4, y + 4);
    await page.mouse.down();
    await page.mouse.move(x + 4 + dx, y + 4 + dy, { steps: 3 });
    await page.mouse.up();
  }
});
