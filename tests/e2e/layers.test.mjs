/** Layers, overlays and their display, with a fake server. */
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { violations } from './accessibility.mjs';
import {
  colourAt,
  colourOf,
  countPixels,
  countsPixels,
  keepPicture,
  hasText,
  showsColour,
  showsColourAt,
  textOf,
} from './browser.mjs';
import { withFakeServer } from './fake_fixture.mjs';
import { FakeSession } from './fake_session.mjs';
import { kMiddle, pixelOf } from './one_tile.mjs';

const kLayers = ['occupancy', 'sonar', 'himm', 'classification'];
describe('layers', () => {
  let server;
  let page;
  let session;
  let complaints = [];
  const openPage = withFakeServer((fresh) => {
    server = fresh;
    session = server.add(new FakeSession('map', 'id-map'));
    session.layers = kLayers;
  });

  const open = async (options) => ({ page, complaints } = await openPage(options));

  it('change by keys, each in its colours, and are kept in the address', async () => {
    session.paint(256, 255, 4); // danger, counter 4, 4 %
    await open();
    await showsColour(page, '--cell-free');
    await page.keyboard.press('v');
    await page.waitForSelector('[name=layer][value=sonar]:checked');
    await page.keyboard.press('v');
    await page.waitForSelector('[name=layer][value=himm]:checked');
    await hasText(page, '#legend', /counter 0/);
    await page.keyboard.press('V'); // Caps Lock
    await showsColour(page, '--class-danger');
    assert.match(page.url(), /layer=classification/);
    await hasText(page, '#legend', /danger/);
    await page.keyboard.press('v');
    await showsColour(page, '--cell-free');
    await page.keyboard.press('b');
    await page.keyboard.press('b');
    await page.keyboard.press('b');
    await page.waitForSelector('[name=layer][value=sonar]:checked');
    await page.reload();
    await page.waitForSelector('[name=layer][value=sonar]:checked');
  });

  it('change by key while a layer selection has the focus, but not in a text field', async () => {
    session.paint(256, 255, 4);
    await open();
    await showsColour(page, '--cell-free');
    await page.focus('[name=layer][value=occupancy]');
    await page.keyboard.press('v');
    await page.waitForSelector('[name=layer][value=sonar]:checked');
    await page.focus('#second-layer');
    await page.keyboard.press('v');
    await page.waitForSelector('[name=layer][value=sonar]:checked');
    await page.focus('#map');
    await page.uncheck('#single-keys');
    await page.keyboard.press('v');
    await page.check('#single-keys');
    await page.waitForSelector('[name=layer][value=sonar]:checked');
  });

  it('request no tiles of hidden layers', async () => {
    session.paint(256, 255, 4);
    await open();
    await showsColour(page, '--cell-free');
    assert.ok(
      server.tileRequests.every((path) => path.includes('/occupancy/')),
      server.tileRequests.join('\n'),
    );
    await page.keyboard.press('b');
    await showsColour(page, '--class-danger');
    const before = server.tileRequests.length;
    session.paint(256, 255, 3);
    await showsColour(page, '--class-frontier');
    const changed = server.tileRequests.slice(before);
    assert.ok(
      changed.every((path) => path.includes('/classification/')),
      changed.join('\n'),
    );
  });

  it('show HIMM counters in their cells when enabled and zoomed in', async () => {
    session.paint(256, 255, 12);
    await open({ hash: '#session=map&layer=himm' });
    await page.waitForSelector('#notice', { state: 'hidden' });
    await page.keyboard.press('g');
    await page.waitForSelector('[data-switch=counters]:checked');
    const label = [255, 255, 255]; // on a dark counter
    await page.mouse.move(...kMiddle);
    assert.equal(await countPixels(page, label), 0, 'cells are too small for numbers');
    await page.emulateMedia({ reducedMotion: 'reduce' }); // each step without animation
    for (let step = 0; step < 7; ++step) await page.click('#zoom-in');
    await page.mouse.move(...kMiddle);
    await countsPixels(page, label, (count) => count > 200);
    assert.match(await textOf(page, '#cursor-value'), /^counter 12$/);
    await keepPicture(page, 'counters');
    await page.keyboard.press('g');
    await page.waitForSelector('[data-switch=counters]:not(:checked)');
    await showsNoPixels(label);
  });

  it('show two layers side by side, with a line that pointer and keys move', async () => {
    session.paint(256, 255, 4);
    await open();
    await showsColour(page, '--cell-free');
    await page.selectOption('#second-layer', 'classification');
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
    // The readout shows the visible layer.
    await page.hover('#map', { position: { x: 500, y: 300 } });
    await hasText(page, '#cursor-value', /^danger$/);
    await page.selectOption('#second-layer', '');
    await page.waitForSelector('#swipe', { state: 'hidden' });
    await showsNoPixels(danger);
  });

  it('overlap, the second with the chosen opacity', async () => {
    session.paint(256, 255, 4);
    await open();
    await showsColour(page, '--cell-free');
    await page.selectOption('#second-layer', 'classification');
    await page.check('#mode-over');
    await setRange('#second-opacity', 100);
    await showsAt(...kMiddle, await colourOf(page, '--class-danger'));
    await setRange('#second-opacity', 0);
    await showsNoPixels(await colourOf(page, '--class-danger'));
    const full = await colourAt(page, ...kMiddle);
    await setRange('#opacity', 20);
    await page.waitForFunction(() => {
      const { data } = document.querySelector('#map canvas').getContext('2d').getImageData(400, 400, 1, 1);
      return data[3] > 0 && data[3] < 80;
    });
    assert.notEqual(full, null);
  });

  it('show all values of a cell', async () => {
    session.paint(256, 255, 3);
    await open();
    await showsColour(page, '--cell-free');
    await page.mouse.move(...kMiddle);
    await hasText(page, '#cursor-value', /^3 % occupied$/);
    await hasText(page, '#cursor-others', /Sonar3 % occupied.*HIMMcounter 3.*Classificationfrontier/);
  });

  it('can be measured by pointer and by keys', async () => {
    session.paint(256, 255, 0);
    await open();
    await showsColour(page, '--cell-free');
    await page.keyboard.press('m');
    await page.mouse.click(...pixelOf(2, 2));
    await page.mouse.click(...pixelOf(5, 6));
    await hasText(page, '#measured', /^(4\.9\d|5\.0\d) m$/);
    await page.mouse.click(...pixelOf(5, 8));
    await hasText(page, '#measured', /^(6\.9\d|7\.0\d) m$/);
    assert.deepEqual(await violations(page), []);
    await page.click('text=Start again');
    await hasText(page, '#measured', /^$/);
    await page.focus('#map');
    await page.keyboard.press('Enter');
    await page.waitForSelector('#crosshair:not([hidden])');
    await hasText(page, '#measured', /^$/);
    await page.keyboard.press('Enter');
    const before = await textOf(page, '#cursor-x');
    await page.keyboard.press('ArrowRight');
    await page.waitForFunction((old) => document.querySelector('#cursor-x').textContent !== old, before);
    await page.keyboard.press('Enter');
    await hasText(page, '#measured', /^\d+\.\d\d m$/);
    await page.keyboard.press('Escape');
    await page.waitForSelector('#tool', { state: 'hidden' });
  });

  it('keep the chosen colours, also the colour-blind safe palette', async () => {
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
    it(`have no accessibility violations: ${scheme}, ${size.join(' x ')}`, async () => {
      session.paint(256, 255, 3);
      session.move('r1', 2, 2, 0);
      await open({ scheme, size });
      await page.waitForSelector('#notice', { state: 'hidden' });
      if (size[0] < 700) await page.click('#panel-toggle');
      await page.selectOption('#second-layer', 'himm');
      assert.deepEqual(await violations(page), []);
      await page.click('#keys-open');
      assert.deepEqual(await violations(page), []);
      await keepPicture(page, `keys-${scheme}-${size[0]}`);
    });
  }

  function showsAt(x, y, colour) {
    return showsColourAt(page, [x, y], colour);
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
