import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import type { TimedTrajectory } from '../../../../web/src/api/history';
import { Refused } from '../../../../web/src/api/http';
import { PastLoader } from '../../../../web/src/time/past_loader';
import { Timeline } from '../../../../web/src/time/timeline';

/** A session whose every revision is a scan, and of which `atOnce` are told at once. */
class World {
  readonly told: string[] = [];
  readonly timeline = new Timeline();
  readonly leave = new AbortController();
  revision = 10;
  atOnce = 4;
  /** The page after this revision is refused. */
  refused = -1;
  /** Called with every question. */
  meanwhile = (): void => {};
  private readonly loader = new PastLoader(this.timeline, () => this.revision, {
    fetchAfter: async (since) => this.page(since),
    loading: (share) => this.told.push(`loading ${share}`),
    loaded: () => this.told.push(`loaded ${this.timeline.count}`),
  });

  load(): Promise<void> {
    return this.loader.load(this.leave.signal);
  }

  private page(since: number): TimedTrajectory {
    assert.ok(this.told.push(`after ${since}`) < 50, 'it comes to an end');
    this.meanwhile();
    if (since === this.refused) throw new Refused(503, 'busy');
    const until = Math.min(this.revision, since + this.atOnce);
    const revisions = Array.from({ length: until - since }, (_, n) => since + 1 + n);
    const points = revisions.map((n): [number, number] => [n, 0]);
    return { revision: until, tracks: [{ robot: 'a', points, revisions, stamps: revisions, yaws: revisions }] };
  }
}

describe('loading the past', () => {
  it('asks for one page after the other, and is done with the last only', async () => {
    const world = new World();
    await world.load();
    assert.deepEqual(world.told, ['after 0', 'loading 0.4', 'after 4', 'loading 0.8', 'after 8', 'loaded 10']);
    assert.deepEqual(world.timeline.revisionOf(9), 10);
  });

  it('knows a session without scans', async () => {
    const world = new World();
    world.revision = 0;
    await world.load();
    await world.load();
    assert.deepEqual(world.told, ['after 0', 'loaded 0']);
  });

  it('goes on behind what has come when a page fails', async () => {
    const world = new World();
    world.refused = 4;
    await assert.rejects(world.load(), Refused);
    assert.deepEqual(world.told, ['after 0', 'loading 0.4', 'after 4']);
    world.refused = -1;
    await world.load();
    assert.deepEqual(world.told.slice(3), ['after 4', 'loading 0.8', 'after 8', 'loaded 10']);
  });

  it('takes what comes later when it is looked for, and asks for nothing else', async () => {
    const world = new World();
    await world.load();
    await world.load();
    world.revision = 16;
    await world.load();
    assert.deepEqual(world.told.slice(5), ['loaded 10', 'after 10', 'after 14', 'loaded 16']);
  });

  it('comes to an end though the session grows with every answer', async () => {
    const world = new World();
    world.meanwhile = () => (world.revision += 4);
    await world.load();
    assert.deepEqual(world.told.slice(-2), ['after 8', 'loaded 12']);
  });

  it('ends with the visit', async () => {
    const world = new World();
    world.meanwhile = () => world.leave.abort();
    await world.load();
    assert.deepEqual(world.told, ['after 0']);
    assert.equal(world.timeline.count, 0);
  });
});
