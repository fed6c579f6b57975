import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { Refused, Unreachable } from '../../../../web/src/api/http';
import type { Point, Trajectory } from '../../../../web/src/api/types';
import { Trails } from '../../../../web/src/live/trails';
import { WholePaths, type Told } from '../../../../web/src/live/whole_paths';

const kRobots = ['a', 'b'];

/** A server of two robots that take turns, position n in revision n + 1. Answers and rests end as the test says. */
class World {
  readonly trails = new Trails();
  readonly leave = new AbortController();
  readonly asked: number[] = [];
  /** After how many failures in a row was rested. */
  readonly rests: number[] = [];
  filled = 0;
  revision = 10;
  atOnce = 100;
  /** What the next questions are answered with. */
  readonly troubles: Error[] = [];
  private readonly held: (() => void)[] = [];
  private readonly paths: WholePaths;

  constructor() {
    const source = { fetchAfter: (since: number) => this.answer(since), filled: () => void ++this.filled };
    this.paths = new WholePaths(this.trails, source, this.leave.signal, (failures) => {
      this.rests.push(failures);
      return new Promise((resolve) => this.held.push(resolve));
    });
  }

  /** Of the newest positions so many a robot are told. */
  hear(newest: number, robots = kRobots): void {
    const told = robots.map((name) => {
      const all = pathOf(name, 0, this.revision);
      const trailFrom = Math.max(0, all.length - newest);
      return { name, trail: all.slice(trailFrom), trailFrom };
    });
    this.tell({ revision: this.revision, robots: told });
  }

  tell(event: Told): void {
    this.paths.hear(event);
  }

  /** Answers what was asked, or ends the rest, and lets happen what follows from it. */
  async next(): Promise<void> {
    assert.equal(this.held.length, 1, 'one thing at a time is waited for');
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
    this.asked.push(since);
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
  it('need no question where events tell all', () => {
    const world = new World();
    world.hear(99);
    world.revision = 14;
    world.hear(2);
    assert.deepEqual(world.asked, []);
    world.assertWhole();
  });

  it('are asked for where an event leaves out their beginning', async () => {
    const world = new World();
    world.hear(1);
    await world.next();
    assert.deepEqual([world.asked, world.filled], [[0], 1]);
    world.assertWhole();
  });

  it('are put together from several pages, and seen with each', async () => {
    const world = new World();
    world.atOnce = 3;
    world.hear(1);
    for (const filled of [1, 2, 3]) {
      await world.next();
      assert.equal(world.filled, filled);
      assert.deepEqual(world.trails.get('a').points, pathOf('a', 0, 3 * filled));
    }
    await world.next();
    assert.deepEqual(world.asked, [0, 3, 6, 9]);
    world.assertWhole();
  });

  it('are asked for once at a time, up to what was left out meanwhile', async () => {
    const world = new World();
    world.atOnce = 10;
    world.hear(1);
    world.revision = 20;
    world.hear(1);
    await world.next();
    await world.next();
    assert.deepEqual(world.asked, [0, 10]);
    world.assertWhole();
  });

  it('go on behind the last page after a failure that passes', async () => {
    const world = new World();
    world.atOnce = 4;
    world.hear(1);
    await world.next();
    world.troubles.push(new Refused(503, 'busy'), new Unreachable('x'));
    for (let n = 0; n < 4; ++n) await world.next();
    assert.deepEqual(
      [world.asked, world.rests],
      [
        [0, 4, 4, 4],
        [1, 2],
      ],
    );
    for (let n = 0; n < 2; ++n) await world.next();
    assert.deepEqual(world.asked, [0, 4, 4, 4, 8]);
    world.assertWhole();
  });

  it('are left where waiting mends nothing, until an event finds the gap again; each time for longer', async () => {
    const world = new World();
    world.hear(1);
    for (const failures of [1, 2, 3]) {
      world.troubles.push(new Refused(500, 'broken'));
      await world.next();
      for (let n = 0; n < 10; ++n) world.hear(1);
      assert.deepEqual([world.asked.length, world.rests.length], [failures, failures], 'events do not end the rest');
      await world.next();
      assert.ok(world.isIdle, 'nobody asks by himself');
      world.hear(1);
    }
    await world.next();
    assert.deepEqual(world.rests, [1, 2, 3]);
    world.assertWhole();
  });

  it('are asked for from what is known after a gap', async () => {
    const world = new World();
    world.hear(1);
    await world.next();
    world.revision = 14;
    world.hear(3);
    world.revision = 40;
    world.hear(1);
    await world.next();
    assert.deepEqual(world.asked, [0, 14]);
    world.assertWhole();
  });

  it('do not take for known what one robot told while another had a gap', async () => {
    const world = new World();
    world.hear(99);
    world.revision = 20;
    world.hear(1, ['b']);
    world.troubles.push(new Refused(500, 'broken'));
    await world.next();
    await world.next();
    world.hear(99, ['a']);
    world.revision = 22;
    world.hear(1);
    await world.next();
    assert.deepEqual(world.asked, [10, 10]);
    world.assertWhole();
  });

  it('are not counted back by an event that a page has overtaken', async () => {
    const world = new World();
    world.hear(99);
    world.revision = 20;
    world.hear(1);
    world.revision = 24;
    await world.next();
    const late = pathOf('a', 0, 21);
    world.tell({ revision: 21, robots: [{ name: 'a', trail: late.slice(-1), trailFrom: late.length - 1 }] });
    world.revision = 40;
    world.hear(1);
    await world.next();
    assert.deepEqual(world.asked, [10, 24]);
    world.assertWhole();
  });

  it('that never get so far are not asked for again and again, and then from the beginning', async () => {
    const world = new World();
    world.hear(99);
    const far = { revision: 10, robots: [{ name: 'a', trail: [], trailFrom: 50 }] };
    world.tell(far);
    await world.next();
    for (let n = 0; n < 10; ++n) world.tell(far);
    assert.deepEqual([world.asked, world.rests], [[10], [1]]);
    await world.next();
    world.tell(far);
    assert.deepEqual(world.asked, [10, 0]);
  });

  it('of a session that lost its end are asked for from the beginning', async () => {
    const world = new World();
    world.hear(99);
    world.revision = 4;
    world.tell({ revision: 12, robots: [{ name: 'a', trail: [], trailFrom: 50 }] });
    await world.next();
    await world.next();
    world.revision = 20;
    world.hear(1);
    await world.next();
    assert.deepEqual(world.asked, [10, 0]);
    world.assertWhole();
  });

  it('that are wanted no more are not asked for further, nor after a failure', async () => {
    const world = new World();
    world.atOnce = 3;
    world.hear(1);
    await world.next();
    world.leave.abort();
    await world.next();
    assert.deepEqual([world.asked, world.filled], [[0, 3], 1]);
    assert.ok(world.isIdle);

    const failing = new World();
    failing.hear(1);
    failing.troubles.push(new Unreachable('x'));
    failing.leave.abort();
    await failing.next();
    assert.deepEqual([failing.asked, failing.rests], [[0], []]);
  });
});
