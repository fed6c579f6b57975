/** Silent failures, and recovery from them. */
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { colourOf, countPixels, hasText, showsColour } from './browser.mjs';
import { withFakeServer } from './fake_fixture.mjs';
import { FakeSession } from './fake_session.mjs';

describe('trouble', () => {
  let server;
  let session;
  const open = withFakeServer((fresh) => {
    server = fresh;
    session = server.add(new FakeSession('map', 'id-map'));
    session.paint(256, 255, 0);
    session.move('r1', 1, 1, 0);
  });

  it('of tiles is reported, and they are requested again without any other event', async () => {
    server.tileFailure = 503;
    const { page } = await open();
    await hasText(page, '#status', /Too busy: try again soon/);
    assert.equal(await countPixels(page, await colourOf(page, '--cell-free')), 0);
    server.tileFailure = null;
    await showsColour(page, '--cell-free');
    await hasText(page, '#status', /^$/);
  });

  it('of a silently dead connection is detected by the session\u2019s known revision', async () => {
    const { page } = await open();
    await showsColour(page, '--cell-free');
    for (const viewer of session.viewers) viewer.isMute = true;
    session.paint(256, 255, 100);
    session.move('r1', 5, 5, 0);
    await showsColour(page, '--cell-occupied');
    await hasText(page, '[data-role=pose]', /x 5\.00, y 5\.00/);
    await hasText(page, '#status', /^$/);
  });

  it('of the trajectory does not cause a flood of requests', async () => {
    for (let step = 0; step < 300; ++step) session.move('r1', 1 + step / 100, 1, 0);
    const tracks = session.tracks.get('r1');
    const { page } = await open();
    await showsColour(page, '--cell-free');
    // The next event starts far after the last known point.
    session.tracks.set('r1', [...tracks, ...tracks.map((each) => ({ ...each, revision: 0 }))]);
    const path = '/api/v1/sessions/map/trajectory.geojson';
    for (let step = 0; step < 20; ++step) session.move('r1', 5, 1 + step / 100, 0);
    await hasText(page, '[data-role=pose]', /y 1\.19/);
    assert.ok(server.requests.filter((each) => each === path).length <= 4);
  });
});
