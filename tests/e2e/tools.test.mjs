/** The tools of the viewer against the real server, on the map of a simulated robot. */
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
  says,
  showsColour,
} from './browser.mjs';
import { pixelsOf } from './map_places.mjs';
import { Server, startRobot } from './programs.mjs';

const kSource = ['simulate', '--world', 'office', '--drive', 'wall_follower', '--seed', '1', '--speed', '0'];
const kPng = Buffer.from([0x89, 0x50, 0x4e, 0x47]);
const kYaml =
  'image: lab.pgm\nresolution: 0.1\norigin: [-2.0, -1.5, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n';

/** What the server's picture of a difference has where only the second map sees an obstacle. */
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

describe('tools on the map', { timeout: 280_000 }, () => {
  let server;
  let browser;
  let page;
  let complaints;
  /** Where the robot was, metres. */
  let track;
  let pixel;

  const api = (path) => `${server.address}api/v1/sessions/demo${path}`;
  const alerted = (pattern) => says(page, '#tool-body [role=alert]', pattern);
  const told = (pattern) => says(page, '#tool-body', pattern);
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

  /** Chromium drops what a page wants to save beyond ten files in a second: whoever gets nothing clicks again. */
  const download = (label) => downloadOnce(label, 10_000).catch(() => downloadOnce(label, 30_000));

  before(async () => {
    server = await Server.start();
    browser = await launchBrowser();
    ({ page, complaints } = await openPage(browser, server.address));
    // The map is where it shall be at once: what is clicked lies where it was looked for.
    await page.emulateMedia({ reducedMotion: 'reduce' });
  });

  after(async () => {
    await browser?.close();
    await server?.stop();
  });

  it('make a session of a ROS map where there is none yet', async () => {
    await says(page, '#notice', /No sessions yet/);
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
    await page.click('#tool-body :text-is("Import")');
    await page.waitForSelector('#notice', { state: 'hidden' });
    assert.match(page.url(), /#session=lab-3$/);
    await showsColour(page, '--cell-occupied');
    await says(page, '#facts', /10 cm/);
  });

  it('tell the sentence of the server when a map cannot be imported', async () => {
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

  describe('of a robot', () => {
    before(async () => {
      const robot = startRobot(server, 'demo', 'r1', [...kSource, '--duration', '150']);
      await new Promise((resolve) => robot.once('exit', resolve));
      const answer = await (await fetch(api('/trajectory.geojson'))).json();
      track = answer.features[0].geometry.coordinates;
      await page.goto(`${server.address}#session=demo`);
      await page.waitForSelector('[data-robot="r1"]');
      await page.waitForSelector('#notice', { state: 'hidden' });
      await showsColour(page, '--cell-free');
      // Robots and trails leave the ways to be seen.
      for (const layer of ['trails', 'points']) await page.uncheck(`[data-switch=${layer}]`);
      await page.click('#fit');
      pixel = await pixelsOf(page);
    });

    // The card lies on the right of the map: what the tests click is left of it.
    const left = (n) => track.filter(([x]) => x < -5)[n];

    it('find a way between two places that are clicked, and another when an end is dragged', async () => {
      await open('p');
      await told(/Click the start of the path/);
      await clickOn(left(300));
      await told(/Click the end of the path/);
      await clickOn(left(600));
      await told(/Path found/);
      const length = await figure('Length');
      assert.match(length, /^\d+\.\d+ m$/);
      assert.ok((await countPixels(page, await colourOf(page, '--way'))) > 100, 'the way is drawn');
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

    it('find a way by keyboard alone, from where the robot is', async () => {
      const [x, y] = track.at(-1);
      await page.mouse.move(5, 5);
      await page.focus('[data-robot="r1"] .follow');
      await page.keyboard.press('Enter');
      await page.focus('#map');
      await says(page, '#cursor-x', new RegExp(`^.${Math.abs(x).toFixed(2)}$`));
      await says(page, '#cursor-y', new RegExp(`^.${Math.abs(y).toFixed(2)}$`));
      await open('p');
      await page.keyboard.press('Enter');
      await told(/Click the end of the path/);
      await page.keyboard.press('ArrowRight');
      await says(page, '#cursor-x', new RegExp(`^(?!.${Math.abs(x).toFixed(2)}$)`));
      await page.keyboard.press('Enter');
      await told(/Path found/);
      await page.click('#fit');
    });

    it('say why there is no way, and find one with other options', async () => {
      await open('p');
      await page.selectOption('#tool-body [name=start]', 'r1');
      await clickOn(left(300));
      await told(/Path found/);
      await page.fill('#tool-body [name=body_radius]', '4');
      await page.press('#tool-body [name=body_radius]', 'Enter');
      await alerted(/^No way there: .*\.$/);
      assert.equal(await page.locator('.tool-figures').count(), 0);
      await page.fill('#tool-body [name=body_radius]', '0.1');
      await page.press('#tool-body [name=body_radius]', 'Enter');
      await told(/Path found/);
    });

    it('cover all ground, or that of a box, and say how much', async () => {
      await open('c');
      await page.click('#tool-body :text-is("Plan path")');
      await told(/Path found/);
      const everything = Number.parseFloat(await figure('Free ground'));
      assert.match(await figure('Covered'), /^(9\d|100)\.\d %$/);
      await page.selectOption('#tool-body [name=region]', 'box');
      await clickOn(left(300));
      await clickOn(left(500));
      await page.waitForSelector('#tool-body :text-is("Draw again")');
      await page.click('#tool-body :text-is("Plan path")');
      await told(/Path found/);
      assert.ok(Number.parseFloat(await figure('Free ground')) < everything / 2);
      await keepPicture(page, 'tool-coverage');
      assert.deepEqual(await violations(page), []);
    });

    it('cover a polygon that a double click closes, and can be given up', async () => {
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
      await told(/Given up/);
      release();
      await page.unroute('**/coverage');
      await page.click('#tool-body :text-is("Plan path")');
      await told(/Path found/);
    });

    it('save maps, of all that was seen or of what is in view', async () => {
      await open('e');
      const whole = await download('PNG');
      assert.equal(whole.name, 'demo.png');
      assert.deepEqual(whole.bytes.subarray(0, 4), kPng);
      assert.deepEqual(whole.bytes, Buffer.from(await (await fetch(api('/map.png'))).arrayBuffer()));
      await says(page, '#tool-body [role=status]', /Saved demo\.png/);
      for (let n = 0; n < 3; ++n) await page.click('#zoom-in');
      await page.selectOption('#tool-body [name=extent]', 'view');
      await page.waitForFunction(() => document.querySelector('.tool-files a').href.includes('bbox='));
      await says(page, '#tool-body .quiet', /About \d+ \u00d7 \d+ cells of 5 cm/);
      const [pgm, yaml] = [await download('PGM'), await download('YAML')];
      assert.deepEqual([pgm.name, yaml.name], ['map.pgm', 'map.yaml']);
      assert.match(pgm.bytes.toString('latin1', 0, 15), /^P5\s/);
      assert.match(yaml.bytes.toString(), /image: map\.pgm[^]*resolution: 0\.05/);
      const edges = new URL(await page.getAttribute('.tool-files a', 'href'), server.address).searchParams.get('bbox');
      const [x] = /origin: \[(.*?),/.exec(yaml.bytes.toString()).slice(1).map(Number);
      assert.ok(Math.abs(x - Number(edges.split(',')[0])) <= 0.1, 'the files are of what is in view');
      await page.selectOption('#tool-body [name=layer]', 'classification');
      const csv = await download('CSV');
      assert.equal(csv.name, 'demo-classification.csv');
      assert.match(csv.bytes.toString('latin1', 0, 200), /^-?\d+(,-?\d+)+/m);
      await page.click('#fit');
    });

    it('save paths, frontiers, logs and the screen, too', async () => {
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
      assert.equal((await download('Paths (GeoJSON)')).bytes.toString(), whole);
      await page.unroute('**/trajectory.geojson');
      assert.equal(JSON.parse((await download('Frontiers (GeoJSON)')).bytes).type, 'FeatureCollection');
      const landmarks = JSON.parse((await download('Landmarks (GeoJSON)')).bytes);
      assert.ok(landmarks.captures > 10 && landmarks.features.length === landmarks.landmarks);
      const log = await download('CARMEN log');
      assert.equal(log.name, 'demo.clf');
      assert.equal(log.bytes.toString().match(/^ROBOTLASER1 /gm).length, 1500);
      assert.equal((await download('Protobuf log')).name, 'demo.scanlog');
      assert.equal((await download('NPY')).bytes.toString('latin1', 1, 6), 'NUMPY');
      const screen = await download('Picture of the screen');
      assert.deepEqual(screen.bytes.subarray(0, 4), kPng);
      const { width, height } = await page.locator('#map').boundingBox();
      assert.deepEqual([screen.bytes.readUInt32BE(16), screen.bytes.readUInt32BE(20)], [width, height]);
      await keepPicture(page, 'tool-export');
      assert.deepEqual(await violations(page), []);
    });

    it('weave the map anew with other settings, and show it beside the present one', async () => {
      await open('w');
      await page.fill('#tool-body [name=cell_size]', '0.1');
      await told(/Changed; the session has 0\.05/);
      await page.selectOption('#tool-body [name=ray_model]', 'bresenham');
      await page.waitForSelector('#tool-body [name=hit_radius]', { state: 'visible' });
      const tile = page.waitForResponse((answer) => /\/tiles\/occupancy\/.*[?&]weave=/.test(answer.url()));
      await page.click('#tool-body :text-is("Weave")');
      assert.equal((await tile).status(), 200);
      await page.waitForSelector('#swipe:not([hidden])');
      await says(page, '.tool-weaves', /cell_size 0\.1, ray_model bresenham/);
      await page.waitForSelector('.tool-weaves [aria-pressed=true]');
      await says(page, '.tool-difference', /Agreement9\d\.\d %/);
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
      await page.selectOption('#tool-body [name=side]', 'beside');
      await page.waitForFunction(() => document.querySelector('.tool-files a').href.includes('weave='));
      assert.match((await download('YAML')).bytes.toString(), /resolution: 0\.1$/m);
    });

    it('delete a weave, and end the comparison with it', async () => {
      await open('w');
      await page.click('.tool-weaves :text-is("Delete")');
      await page.waitForSelector('#swipe', { state: 'hidden' });
      await page.waitForSelector('.tool-weaves li', { state: 'detached' });
      assert.deepEqual((await (await fetch(api('/weave'))).json()).weaves, []);
    });

    it('are there on a phone and by night', async () => {
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
