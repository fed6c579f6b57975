/** The tools of the viewer with the real server, on the map of a simulated robot. */
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { after, before, describe, it } from 'node:test';
import { violations } from './accessibility.mjs';
import {
  colourOf,
  countPixels,
  countsPixels,
  keepPicture,
  launchBrowser,
  openPage,
  hasText,
  showsColour,
} from './browser.mjs';
import { pixelsOf } from './map_places.mjs';
import { Server, startRobot } from './programs.mjs';

const kSource = ['simulate', '--world', 'office', '--drive', 'wall_follower', '--seed', '1', '--speed', '0'];
const kPng = Buffer.from([0x89, 0x50, 0x4e, 0x47]);
const kYaml =
  'image: lab.pgm\nresolution: 0.1\norigin: [-2.0, -1.5, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n';

/** The colour of cells in the server's difference picture where only the second map has an obstacle. */
const kOnlyInWeave = [213, 94, 0];

/** A room of 40 x 30 cells with a wall around it. */
function roomPgm() {
  const [width, height] = [40, 30];
  const cells = Buffer.alloc(width * height, 254);
  for (let n = 0; n < cells.length; ++n) {
    const [x, y] = [n % width, Math.floor(n / width)];
    if (x < 2 || y < 2 || x >= width - 2 || y >= height - 2) cells[n] = 0;
  }
  return Buffer.concat([Buffer.from(`P5\n${width} ${height}\n255\n`), cells]);
}

describe('tools on the map', () => {
  let server;
  let browser;
  let page;
  let complaints;
  /** Places where the robot was, metres. */
  let track;
  let pixel;

  const api = (path) => `${server.address}api/v1/sessions/demo${path}`;
  const alerted = (pattern) => hasText(page, '#tool-body [role=alert]', pattern);
  const shows = (pattern) => hasText(page, '#tool-body', pattern);
  const figure = async (name) =>
    page
      .locator('.tool-figures div', { has: page.locator('dt', { hasText: name }) })
      .locator('dd')
      .textContent();
  const clickOn = async (place) => page.mouse.click(...pixel(place));

  const open = async (key) => {
    await page.keyboard.press('Escape');
    await page.focus('#map');
    await page.keyboard.press(key);
    await page.waitForSelector('#tool:not([hidden])');
  };

  const downloadOnce = async (label, timeout) => {
    const [file] = await Promise.all([
      page.waitForEvent('download', { timeout }),
      page.click(`#tool-body :text-is("${label}")`),
    ]);
    return { name: file.suggestedFilename(), bytes: await readFile(await file.path()) };
  };

  /** Chromium drops downloads beyond ten in a second: if none arrives, click again. */
  const download = (label) => downloadOnce(label, 10_000).catch(() => downloadOnce(label, 30_000));

  before(async () => {
    server = await Server.start();
    browser = await launchBrowser();
    ({ page, complaints } = await openPage(browser, server.address));
    // Without animation, the map is at its final place when the test clicks.
    await page.emulateMedia({ reducedMotion: 'reduce' });
  });

  after(async () => {
    await browser?.close();
    await server?.stop();
  });

  it('create a session from a ROS map on a server without sessions', async () => {
    await hasText(page, '#notice', /No sessions yet/);
    await page.click('#import-open');
    await page.waitForSelector('#tool[data-tool="import"]', { state: 'visible' });
    await keepPicture(page, 'tool-import');
    assert.deepEqual(await violations(page), []);
    await page.setInputFiles('[name=yaml]', { name: 'lab 3.yaml', mimeType: 'text/yaml', buffer: Buffer.from(kYaml) });
    await page.setInputFiles('[name=image]', {
      name: 'lab.pgm',
      mimeType: 'image/x-portable-graymap',
      buffer: roomPgm(),
    });
    assert.equal(await page.inputValue('#tool-body [name=name]'), 'lab-3');
    await page.check('#tool-body [name=localize_only]');
    await page.click('#tool-body :text-is("Import")');
    await page.waitForSelector('#notice', { state: 'hidden' });
    assert.match(page.url(), /#session=lab-3$/);
    await showsColour(page, '--cell-occupied');
    await hasText(page, '#facts', /10 cm.*Localize only: the map does not change$/);
    await page.click('#mode :text-is("Continue mapping")');
    await hasText(page, '#facts', /Mapping$/);
  });

  it('show the server\u2019s message when a map cannot be imported', async () => {
    await open('i');
    await drop(['lab.yaml', kYaml], ['lab.pgm', 'P5 nonsense']);
    assert.equal(await page.inputValue('#tool-body [name=name]'), 'lab');
    await page.click('#tool-body :text-is("Import")');
    await alerted(/\S.*\.$/);
    assert.match(page.url(), /#session=lab-3$/);
    await page.fill('#tool-body [name=name]', 'no name!');
    assert.equal(await page.locator('#tool-body [name=name]:invalid').count(), 1);
    await drop(['notes.txt', 'x']);
    await alerted(/notes\.txt is neither a description/);
    await drop(['lab.yaml', kYaml], ['lab.pgm', [...roomPgm()]]);
    await page.fill('#tool-body [name=name]', 'another');
    await page.click('#tool-body :text-is("Import")');
    await page.waitForURL(/#session=another$/);
    await hasText(page, '#facts', /Mapping$/);
    await page.waitForSelector('#tool', { state: 'hidden' });
  });

  async function drop(...files) {
    const data = await page.evaluateHandle((all) => {
      const transfer = new DataTransfer();
      for (const [name, content] of all)
        transfer.items.add(new File([Array.isArray(content) ? new Uint8Array(content) : content], name));
      return transfer;
    }, files);
    await page.dispatchEvent('#tool', 'drop', { dataTransfer: data });
  }

  describe('with a robot', () => {
    before(async () => {
      const robot = startRobot(server, 'demo', 'r1', [...kSource, '--duration', '150']);
      await new Promise((resolve) => robot.once('exit', resolve));
      const answer = await (await fetch(api('/trajectory.geojson'))).json();
      track = answer.features[0].geometry.coordinates;
      await page.goto(`${server.address}#session=demo`);
      await page.waitForSelector('[data-robot="r1"]');
      await page.waitForSelector('#notice', { state: 'hidden' });
      await showsColour(page, '--cell-free');
      // Robots and trails must not cover the paths.
      for (const layer of ['trails', 'points']) await page.uncheck(`[data-switch=${layer}]`);
      await page.click('#fit');
      pixel = await pixelsOf(page);
    });

    // The card covers the right of the map: the tests click left of it.
    const left = (n) => track.filter(([x]) => x < -5)[n];

    it('plan a path between two clicked places, and again when an end is dragged', async () => {
      await open('p');
      await shows(/Click the start of the path/);
      await clickOn(left(300));
      await shows(/Click the end of the path/);
      await clickOn(left(600));
      await shows(/Path found/);
      const length = await figure('Length');
      assert.match(length, /^\d+\.\d+ m$/);
      assert.ok((await countPixels(page, await colourOf(page, '--path'))) > 100, 'the path is drawn');
      await page.mouse.move(...pixel(left(600)));
      await page.mouse.down();
      await page.mouse.move(...pixel(left(450)), { steps: 5 });
      await page.mouse.up();
      await page.waitForFunction(
        (old) => ![null, old].includes(document.querySelector('.tool-figures dd')?.textContent ?? null),
        length,
      );
      await keepPicture(page, 'tool-path');
      assert.deepEqual(await violations(page), []);
    });

    it('plan a path with the keyboard alone, from the robot', async () => {
      const [x, y] = track.at(-1);
      await page.mouse.move(5, 5);
      await page.focus('[data-robot="r1"] .follow');
      await page.keyboard.press('Enter');
      await page.focus('#map');
      await hasText(page, '#cursor-x', new RegExp(`^.${Math.abs(x).toFixed(2)}$`));
      await hasText(page, '#cursor-y', new RegExp(`^.${Math.abs(y).toFixed(2)}$`));
      await open('p');
      await page.keyboard.press('Enter');
      await shows(/Click the end of the path/);
      await page.keyboard.press('ArrowRight');
      await hasText(page, '#cursor-x', new RegExp(`^(?!.${Math.abs(x).toFixed(2)}$)`));
      await page.keyboard.press('Enter');
      await shows(/Path found/);
      await page.click('#fit');
    });

    it('report why there is no path, and plan one with other options', async () => {
      await open('p');
      await page.selectOption('#tool-body [name=start]', 'r1');
      await clickOn(left(300));
      await shows(/Path found/);
      await page.fill('#tool-body [name=body_radius]', '4');
      await page.press('#tool-body [name=body_radius]', 'Enter');
      await alerted(/^No path: .*\.$/);
      assert.equal(await page.locator('.tool-figures').count(), 0);
      await page.fill('#tool-body [name=body_radius]', '0.1');
      await page.press('#tool-body [name=body_radius]', 'Enter');
      await shows(/Path found/);
    });

    it('plan coverage of all ground, or of a box, and show its area', async () => {
      await open('c');
      await page.click('#tool-body :text-is("Plan path")');
      await shows(/Path found/);
      const everything = Number.parseFloat(await figure('Free ground'));
      assert.match(await figure('Covered'), /^(9\d|100)\.\d %$/);
      await page.selectOption('#tool-body [name=region]', 'box');
      await clickOn(left(300));
      await clickOn(left(500));
      await page.waitForSelector('#tool-body :text-is("Draw again")');
      await page.click('#tool-body :text-is("Plan path")');
      await shows(/Path found/);
      assert.ok(Number.parseFloat(await figure('Free ground')) < everything / 2);
      await keepPicture(page, 'tool-coverage');
      assert.deepEqual(await violations(page), []);
    });

    it('plan coverage of a polygon that a double click closes, and can be cancelled', async () => {
      await open('c');
      await page.selectOption('#tool-body [name=region]', 'polygon');
      const corners = [300, 400, 500].map(left);
      for (const corner of corners.slice(0, 2)) await clickOn(corner);
      await page.mouse.dblclick(...pixel(corners[2]));
      await page.waitForSelector('#tool-body :text-is("Draw again")');
      let release;
      const held = new Promise((resolve) => (release = resolve));
      await page.route('**/coverage', async (route) => {
        await held;
        await route.abort().catch(() => {});
      });
      await page.click('#tool-body :text-is("Plan path")');
      await page.click('#tool-body :text-is("Cancel")');
      await shows(/Cancelled/);
      release();
      await page.unroute('**/coverage');
      await page.click('#tool-body :text-is("Plan path")');
      await shows(/Path found/);
    });

    it('save the whole map or the visible part', async () => {
      await open('e');
      const whole = await download('PNG');
      assert.equal(whole.name, 'demo.png');
      assert.deepEqual(whole.bytes.subarray(0, 4), kPng);
      assert.deepEqual(whole.bytes, Buffer.from(await (await fetch(api('/map.png'))).arrayBuffer()));
      await hasText(page, '#tool-body [role=status]', /Saved demo\.png/);
      for (let n = 0; n < 3; ++n) await page.click('#zoom-in');
      await page.selectOption('#tool-body [name=extent]', 'view');
      await page.waitForFunction(() => document.querySelector('.tool-files a').href.includes('bbox='));
      await hasText(page, '#tool-body .quiet', /About \d+ \u00d7 \d+ cells of 5 cm/);
      const [pgm, yaml] = [await download('PGM'), await download('YAML')];
      assert.deepEqual([pgm.name, yaml.name], ['map.pgm', 'map.yaml']);
      assert.match(pgm.bytes.toString('latin1', 0, 15), /^P5\s/);
      assert.match(yaml.bytes.toString(), /image: map\.pgm[^]*resolution: 0\.05/);
      const edges = new URL(await page.getAttribute('.tool-files a', 'href'), server.address).searchParams.get('bbox');
      const [x] = /origin: \[(.*?),/.exec(yaml.bytes.toString()).slice(1).map(Number);
      assert.ok(Math.abs(x - Number(edges.split(',')[0])) <= 0.1, 'the files contain the visible part');
      await page.selectOption('#tool-body [name=layer]', 'classification');
      const csv = await download('CSV');
      assert.equal(csv.name, 'demo-classification.csv');
      assert.match(csv.bytes.toString('latin1', 0, 200), /^-?\d+(,-?\d+)+/m);
      await page.click('#fit');
    });

    it('save trajectories, frontiers, logs and a screenshot', async () => {
      await open('e');
      const whole = await (await fetch(api('/trajectory.geojson'))).text();
      const { properties } = (await (await fetch(api('/trajectory.geojson?times=true'))).json()).features[0];
      // The first answer ends with the 700th position.
      await page.route('**/trajectory.geojson', async (route) => {
        const json = JSON.parse(whole);
        json.revision = properties.revisions[699];
        json.features[0].geometry.coordinates.length = json.features[0].properties.points = 700;
        await route.fulfill({ json });
      });
      assert.equal((await download('Trajectories (GeoJSON)')).bytes.toString(), whole);
      await page.unroute('**/trajectory.geojson');
      assert.equal(JSON.parse((await download('Frontiers (GeoJSON)')).bytes).type, 'FeatureCollection');
      const landmarks = JSON.parse((await download('Landmarks (GeoJSON)')).bytes);
      assert.ok(landmarks.captures > 10 && landmarks.features.length === landmarks.landmarks);
      const log = await download('CARMEN log');
      assert.equal(log.name, 'demo.clf');
      assert.equal(log.bytes.toString().match(/^ROBOTLASER1 /gm).length, 1500);
      assert.equal((await download('Protobuf log')).name, 'demo.scanlog');
      assert.equal((await download('NPY')).bytes.toString('latin1', 1, 6), 'NUMPY');
      const screen = await download('Screenshot');
      assert.deepEqual(screen.bytes.subarray(0, 4), kPng);
      const { width, height } = await page.locator('#map').boundingBox();
      assert.deepEqual([screen.bytes.readUInt32BE(16), screen.bytes.readUInt32BE(20)], [width, height]);
      await keepPicture(page, 'tool-export');
      assert.deepEqual(await violations(page), []);
    });

    it('compute the map with other settings, and show it next to the present one', async () => {
      await open('w');
      await page.fill('#tool-body [name=cell_size]', '0.1');
      await shows(/Changed; the session has 0\.05/);
      await page.selectOption('#tool-body [name=ray_model]', 'bresenham');
      await page.waitForSelector('#tool-body [name=hit_radius]', { state: 'visible' });
      const tile = page.waitForResponse((answer) => /\/tiles\/occupancy\/.*[?&]weave=/.test(answer.url()));
      await page.click('#tool-body :text-is("Weave")');
      assert.equal((await tile).status(), 200);
      await page.waitForSelector('#swipe:not([hidden])');
      await hasText(page, '.tool-weaves', /cell_size 0\.1, ray_model bresenham/);
      await page.waitForSelector('.tool-weaves [aria-pressed=true]');
      await hasText(page, '.tool-difference', /Agreement9\d\.\d %/);
      await page.check('[name=difference]');
      await countsPixels(page, kOnlyInWeave, (pixels) => pixels > 100);
      await keepPicture(page, 'tool-weave-difference');
      await page.uncheck('[name=difference]');
      await countsPixels(page, kOnlyInWeave, (pixels) => pixels === 0);
      await keepPicture(page, 'tool-weave');
      assert.deepEqual(await violations(page), []);
    });

    it('export the weave that is on the second side', async () => {
      await open('e');
      await page.selectOption('#tool-body [name=side]', 'second');
      await page.waitForFunction(() => document.querySelector('.tool-files a').href.includes('weave='));
      assert.match((await download('YAML')).bytes.toString(), /resolution: 0\.1$/m);
    });

    it('delete a weave, which ends the comparison', async () => {
      await open('w');
      await page.click('.tool-weaves :text-is("Delete")');
      await page.waitForSelector('#swipe', { state: 'hidden' });
      await page.waitForSelector('.tool-weaves li', { state: 'detached' });
      assert.deepEqual((await (await fetch(api('/weave'))).json()).weaves, []);
    });

    it('work on a phone and with dark colours', async () => {
      const phone = await openPage(browser, server.address, {
        ...{ hash: '#session=demo', size: [390, 844], scheme: 'dark' },
      });
      await showsColour(phone.page, '--cell-free');
      for (const tool of ['path', 'coverage', 'weave', 'import', 'export']) {
        await phone.page.click(`#tool-${tool}`);
        await phone.page.waitForSelector(`#tool[data-tool=${tool}]`, { state: 'visible' });
        assert.deepEqual(await violations(phone.page), [], tool);
        const [card, map] = await Promise.all(['#tool', '#map'].map((id) => phone.page.locator(id).boundingBox()));
        assert.equal(card.width, map.width);
        assert.ok(card.y >= map.y + map.height && map.height > 300, `${tool} leaves the map in view`);
        const start = phone.page.locator('#tool .primary');
        if ((await start.count()) > 0) {
          const { y, height } = await start.boundingBox();
          assert.ok(y + height <= card.y + card.height, `the button of ${tool} is not cut off`);
        }
        await keepPicture(phone.page, `tool-${tool}-phone`);
      }
      assert.deepEqual(phone.complaints, []);
      await phone.page.context().close();
      assert.deepEqual(complaints, []);
    });
  });
});
