import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import type { TimedTrajectory } from '../../../../web/src/api/history';
import { Refused } from '../../../../web/src/api/http';
import { PastLoader } from '../../../../web/src/time/past_loader';
import { Timeline } from '../../../../web/src/time/timeline';

/** A session in which every revision is a scan, with `atOnce` revisions per page. */
class World {
  readonly log: string[] = [];
  readonly timeline = new Timeline();
  readonly leave = new AbortController();
  revision = 10;
  atOnce = 4;
  /** The request for the page after this revision is refused. */
  refused = -1;
  /** Called for every request. */
  meanwhile = (): void => {};
  private readonly loader = new PastLoader(this.timeline, () => this.revision, {
    fetchAfter: async (since) => this.page(since),
    loading: (share) => this.log.push(`loading ${share}`),
    loaded: () => this.log.push(`loaded ${this.timeline.count}`),
  });

  load(): Promise<void> {
    return this.loader.load(this.leave.signal);
  }

  private page(since: number): TimedTrajectory {
    assert.ok(this.log.push(`after ${since}`) < 50, 'the requests must end');
    this.meanwhile();
    if (since === this.refused) throw new Refused(503, 'busy');
    const until = Math.min(this.revision, since + this.atOnce);
    const revisions = Array.from({ length: until - since }, (_, n) => since + 1 + n);
    const points = revisions.map((n): [number, number] => [n, 0]);
    return { revision: until, tracks: [{ robot: 'a', points, revisions, stamps: revisions, yaws: revisions }] };
  }
}

describe('loading the history', () => {
  it('requests pages in order and finishes with the last one', async () => {
    const world = new World();
    await world.load();
    assert.deepEqual(world.log, ['after 0', 'loading 0.4', 'after 4', 'loading 0.8', 'after 8', 'loaded 10']);
    assert.deepEqual(world.timeline.revisionOf(9), 10);
  });

  it('accepts a session without scans', async () => {
    const world = new World();
    world.revision = 0;
    await world.load();
    await world.load();
    assert.deepEqual(world.log, ['after 0', 'loaded 0']);
  });

  it('continues after the received pages when a page fails', async () => {
    const world = new World();
    world.refused = 4;
    await assert.rejects(world.load(), Refused);
    assert.deepEqual(world.log, ['after 0', 'loading 0.4', 'after 4']);
    world.refused = -1;
    await world.load();
    assert.deepEqual(world.log.slice(3), ['after 4', 'loading 0.8', 'after 8', 'loaded 10']);
  });

  it('requests only later pages on the next load', async () => {
    const world = new World();
    await world.load();
    await world.load();
    world.revision = 16;
    await world.load();
    assert.deepEqual(world.log.slice(5), ['loaded 10', 'after 10', 'after 14', 'loaded 16']);
  });

  it('ends although the session grows with every answer', async () => {
    const world = new World();
    world.meanwhile = () => (world.revision += 4);
    await world.load();
    assert.deepEqual(world.log.slice(-2), ['after 8', 'loaded 12']);
  });

  it('ends when the page is left', async () => {
    const world = new World();
    world.meanwhile = () => world.leave.abort();
    await world.load();
    assert.deepEqual(world.log, ['after 0']);
    assert.equal(world.timeline.count, 0);
  });
});
