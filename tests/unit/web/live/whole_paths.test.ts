import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { Refused, Unreachable } from '../../../../web/src/api/http';
import type { Point, Trajectory } from '../../../../web/src/api/types';
import { Trails } from '../../../../web/src/live/trails';
import { WholePaths, type TrailEvent } from '../../../../web/src/live/whole_paths';

const kRobots = ['a', 'b'];

/** A server with two robots that alternate: position n is revision n + 1. The test ends answers and pauses. */
class World {
  readonly trails = new Trails();
  readonly leave = new AbortController();
  readonly requests: number[] = [];
  /** Number of consecutive failures before each pause. */
  readonly pauses: number[] = [];
  filled = 0;
  revision = 10;
  atOnce = 100;
  /** Errors with which the next requests fail. */
  readonly troubles: Error[] = [];
  private readonly held: (() => void)[] = [];
  private readonly paths: WholePaths;

  constructor() {
    const source = { fetchAfter: (since: number) => this.answer(since), filled: () => void ++this.filled };
    this.paths = new WholePaths(this.trails, source, this.leave.signal, (failures) => {
      this.pauses.push(failures);
      return new Promise((resolve) => this.held.push(resolve));
    });
  }

  /** Sends an event with the `newest` positions of each robot. */
  sendNewest(newest: number, robots = kRobots): void {
    const sent = robots.map((name) => {
      const all = pathOf(name, 0, this.revision);
      const trailFrom = Math.max(0, all.length - newest);
      return { name, trail: all.slice(trailFrom), trailFrom };
    });
    this.send({ revision: this.revision, robots: sent });
  }

  send(event: TrailEvent): void {
    this.paths.apply(event);
  }

  /** Answers the pending request or ends the pause, then runs pending tasks. */
  async next(): Promise<void> {
    assert.equal(this.held.length, 1, 'exactly one request or pause must be pending');
    this.held.shift()?.();
    await new Promise((resolve) => setImmediate(resolve));
  }

  get isIdle(): boolean {
    return this.held.length === 0;
  }

  assertWhole(): void {
    for (const robot of kRobots) {
      assert.deepEqual(this.trails.get(robot).points, pathOf(robot, 0, this.revision), robot);
    }
    assert.ok(this.isIdle);
  }

  private async answer(since: number): Promise<Trajectory> {
    this.requests.push(since);
    await new Promise<void>((resolve) => this.held.push(resolve));
    const trouble = this.troubles.shift();
    if (trouble) throw trouble;
    const revision = Math.min(this.revision, since + this.atOnce);
    return { revision, tracks: kRobots.map((robot) => ({ robot, points: pathOf(robot, since, revision) })) };
  }
}

function pathOf(robot: string, since: number, until: number): Point[] {
  const all = Array.from({ length: until }, (_, n): Point => [n, 0]);
  return all.filter((_, n) => n >= since && kRobots[n % 2] === robot);
}

describe('whole paths', () => {
  it('need no request if events contain all points', () => {
    const world = new World();
    world.sendNewest(99);
    world.revision = 14;
    world.sendNewest(2);
    assert.deepEqual(world.requests, []);
    world.assertWhole();
  });

  it('are requested if an event omits their beginning', async () => {
    const world = new World();
    world.sendNewest(1);
    await world.next();
    assert.deepEqual([world.requests, world.filled], [[0], 1]);
    world.assertWhole();
  });

  it('are assembled from several pages and updated with each', async () => {
    const world = new World();
    world.atOnce = 3;
    world.sendNewest(1);
    for (const filled of [1, 2, 3]) {
      await world.next();
      assert.equal(world.filled, filled);
      assert.deepEqual(world.trails.get('a').points, pathOf('a', 0, 3 * filled));
    }
    await world.next();
    assert.deepEqual(world.requests, [0, 3, 6, 9]);
    world.assertWhole();
  });

  it('are requested one page at a time up to the newest omitted point', async () => {
    const world = new World();
    world.atOnce = 10;
    world.sendNewest(1);
    world.revision = 20;
    world.sendNewest(1);
    await world.next();
    await world.next();
    assert.deepEqual(world.requests, [0, 10]);
    world.assertWhole();
  });

  it('continue after the last page when a temporary failure ends', async () => {
    const world = new World();
    world.atOnce = 4;
    world.sendNewest(1);
    await world.next();
    world.troubles.push(new Refused(503, 'busy'), new Unreachable('x'));
    for (let n = 0; n < 4; ++n) await world.next();
    assert.deepEqual(
      [world.requests, world.pauses],
      [
        [0, 4, 4, 4],
        [1, 2],
      ],
    );
    for (let n = 0; n < 2; ++n) await world.next();
    assert.deepEqual(world.requests, [0, 4, 4, 4, 8]);
    world.assertWhole();
  });

  it('wait for another event after a permanent failure, longer each time', async () => {
    const world = new World();
    world.sendNewest(1);
    for (const failures of [1, 2, 3]) {
      world.troubles.push(new Refused(500, 'broken'));
      await world.next();
      for (let n = 0; n < 10; ++n) world.sendNewest(1);
      assert.deepEqual(
        [world.requests.length, world.pauses.length],
        [failures, failures],
        'events must not end the pause',
      );
      await world.next();
      assert.ok(world.isIdle, 'no request must follow without an event');
      world.sendNewest(1);
    }
    await world.next();
    assert.deepEqual(world.pauses, [1, 2, 3]);
    world.assertWhole();
  });

  it('are requested from the last known revision after a gap', async () => {
    const world = new World();
    world.sendNewest(1);
    await world.next();
    world.revision = 14;
    world.sendNewest(3);
    world.revision = 40;
    world.sendNewest(1);
    await world.next();
    assert.deepEqual(world.requests, [0, 14]);
    world.assertWhole();
  });

  it('treat a revision as known only if no robot has a gap', async () => {
    const world = new World();
    world.sendNewest(99);
    world.revision = 20;
    world.sendNewest(1, ['b']);
    world.troubles.push(new Refused(500, 'broken'));
    await world.next();
    await world.next();
    world.sendNewest(99, ['a']);
    world.revision = 22;
    world.sendNewest(1);
    await world.next();
    assert.deepEqual(world.requests, [10, 10]);
    world.assertWhole();
  });

  it('ignore an event older than a received page', async () => {
    const world = new World();
    world.sendNewest(99);
    world.revision = 20;
    world.sendNewest(1);
    world.revision = 24;
    await world.next();
    const late = pathOf('a', 0, 21);
    world.send({ revision: 21, robots: [{ name: 'a', trail: late.slice(-1), trailFrom: late.length - 1 }] });
    world.revision = 40;
    world.sendNewest(1);
    await world.next();
    assert.deepEqual(world.requests, [10, 24]);
    world.assertWhole();
  });

  it('are requested after a pause from the beginning if they never reach the event', async () => {
    const world = new World();
    world.sendNewest(99);
    const far = { revision: 10, robots: [{ name: 'a', trail: [], trailFrom: 50 }] };
    world.send(far);
    await world.next();
    for (let n = 0; n < 10; ++n) world.send(far);
    assert.deepEqual([world.requests, world.pauses], [[10], [1]]);
    await world.next();
    world.send(far);
    assert.deepEqual(world.requests, [10, 0]);
  });

  it('of a truncated session are requested from the beginning', async () => {
    const world = new World();
    world.sendNewest(99);
    world.revision = 4;
    world.send({ revision: 12, robots: [{ name: 'a', trail: [], trailFrom: 50 }] });
    await world.next();
    await world.next();
    world.revision = 20;
    world.sendNewest(1);
    await world.next();
    assert.deepEqual(world.requests, [10, 0]);
    world.assertWhole();
  });

  it('are not requested after the page is left', async () => {
    const world = new World();
    world.atOnce = 3;
    world.sendNewest(1);
    await world.next();
    world.leave.abort();
    await world.next();
    assert.deepEqual([world.requests, world.filled], [[0, 3], 1]);
    assert.ok(world.isIdle);

    const failing = new World();
    failing.sendNewest(1);
    failing.troubles.push(new Unreachable('x'));
    failing.leave.abort();
    await failing.next();
    assert.deepEqual([failing.requests, failing.pauses], [[0], []]);
  });
});
