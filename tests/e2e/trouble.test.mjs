/** What goes wrong without a word, and comes right by itself. */
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { colourOf, countPixels, says, showsColour } from './browser.mjs';
import { withFakeServer } from './fake_fixture.mjs';
import { FakeSession } from './fake_session.mjs';

describe('trouble', { timeout: 120_000 }, () => {
  let server;
  let session;
  const open = withFakeServer((fresh) => {
    server = fresh;
    session = server.add(new FakeSession('map', 'id-map'));
    session.paint(256, 255, 0);
    session.move('r1', 1, 1, 0);
  });

  it('of tiles is told, and they are asked for again although nothing else happens', async () => {
    server.tileFailure = 503;
    const { page } = await open();
    await says(page, '#status', /Too busy: try again soon/);
    assert.equal(await countPixels(page, await colourOf(page, '--cell-free')), 0);
    server.tileFailure = null;
    await showsColour(page, '--cell-free');
    await says(page, '#status', /^$/);
  });

  it('of a connection that died silently is noticed by what the server is known to have', async () => {
    const { page } = await open();
    await showsColour(page, '--cell-free');
    for (const viewer of session.viewers) viewer.isMute = true;
    session.paint(256, 255, 100);
    session.move('r1', 5, 5, 0);
    await showsColour(page, '--cell-occupied');
    await says(page, '[data-role=pose]', /x 5\.00, y 5\.00/);
    await says(page, '#status', /^$/);
  });

  it('of the path does not make a storm of questions', async () => {
    for (let step = 0; step < 300; ++step) session.move('r1', 1 + step / 100, 1, 0);
    const tracks = session.tracks.get('r1');
    const { page } = await open();
    await showsColour(page, '--cell-free');
    // The next event begins far behind what the page knows.
    session.tracks.set('r1', [...tracks, ...tracks.map((each) => ({ ...each, revision: 0 }))]);
    const path = '/api/v1/sessions/map/trajectory.geojson';
    for (let step = 0; step < 20; ++step) session.move('r1', 5, 1 + step / 100, 0);
    await says(page, '[data-role=pose]', /y 1\.19/);
    assert.ok(server.requests.filter((each) => each === path).length <= 4);
  });
});
