import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { Refused, Unreachable } from '../../../../web/src/api/http';
import type { Weave } from '../../../../web/src/api/weaves';
import { LiveSource, type MapSource } from '../../../../web/src/map/map_source';
import { TimeTravel } from '../../../../web/src/time/time_travel';

const kKeepMs = 10_000;

/** A server that weaves `perAsk` entries between two questions, and a clock that runs while somebody waits. */
class World {
  readonly asked: string[] = [];
  readonly told: string[] = [];
  readonly leave = new AbortController();
  perAsk = Infinity;
  now = 0;
  trouble: Error | null = null;
  failed: ((error: unknown) => void) | null = null;
  private readonly woven = new Map<string, number>();
  private readonly keepers: (() => void)[] = [];
  readonly travel: TimeTravel;

  constructor() {
    const source: MapSource = new LiveSource({ name: 's', id: '1' }, 0.05, 'own');
    this.travel = new TimeTravel(
      {
        start: async (revision) => {
          this.asked.push(`start ${revision}`);
          if (this.trouble) throw this.trouble;
          this.woven.set(String(revision), this.woven.get(String(revision)) ?? Math.min(revision, this.perAsk));
          return this.weave(String(revision));
        },
        progress: async (id) => {
          this.asked.push(`progress ${id}`);
          if (this.trouble) throw this.trouble;
          if (!this.woven.has(id)) throw new Refused(404, 'no such weave');
          this.woven.set(id, Math.min(Number(id), (this.woven.get(id) ?? 0) + this.perAsk));
          return this.weave(id);
        },
        cancel: async (id) => void this.asked.push(`cancel ${id}`),
        load: async (id, failed) => {
          this.asked.push(`load ${id}`);
          this.failed = failed;
          return source;
        },
      },
      {
        arrived: (revision) => this.told.push(`arrived ${revision}`),
        weaving: (woven, until) => this.told.push(`weaving ${woven}/${until}`),
        failed: (error, trying) => this.told.push(`failed ${(error as Error).message} ${trying}`),
        rested: () => this.told.push('rested'),
      },
      this.leave.signal,
      {
        now: () => this.now,
        rest: (durationMs) => {
          // The watch over what is shown rests until the test says so.
          if (durationMs === kKeepMs) return new Promise((resolve) => this.keepers.push(resolve));
          this.now += durationMs;
          return new Promise((resolve) => setImmediate(resolve));
        },
      },
    );
  }

  lookAfter(): void {
    for (const keeper of this.keepers.splice(0)) keeper();
  }

  forget(): void {
    this.woven.clear();
  }

  async settle(): Promise<void> {
    for (let turn = 0; turn < 200; ++turn) await new Promise((resolve) => setImmediate(resolve));
  }

  /** Waits until something is told, but not for ever. */
  async hears(expected: (line: string) => boolean): Promise<void> {
    for (let turn = 0; turn < 2_000 && !this.told.some(expected); ++turn) {
      await new Promise((resolve) => setImmediate(resolve));
    }
    assert.ok(this.told.some(expected), this.told.join());
  }

  private weave(id: string): Weave {
    const woven = this.woven.get(id) ?? 0;
    return { id, state: woven < Number(id) ? 'weaving' : 'done', woven, until: Number(id), exclusions: 0, reason: '' };
  }
}

describe('travelling in time', () => {
  it('asks for a weave, waits until it is done and loads it', async () => {
    const world = new World();
    world.perAsk = 10;
    world.travel.go(25);
    await world.settle();
    assert.deepEqual(world.asked, ['start 25', 'progress 25', 'progress 25', 'load 25']);
    assert.deepEqual(world.told, ['arrived 25', 'rested']);
  });

  it('has one weave under way, and goes on to the newest that was wanted meanwhile', async () => {
    const world = new World();
    for (let revision = 1; revision <= 50; ++revision) world.travel.go(revision);
    await world.settle();
    assert.deepEqual(world.asked, ['start 1', 'load 1', 'start 50', 'load 50']);
    assert.deepEqual(world.told, ['arrived 1', 'arrived 50', 'rested']);
  });

  it('asks for nothing where it is already', async () => {
    const world = new World();
    world.travel.go(5);
    await world.settle();
    world.travel.go(5);
    await world.settle();
    assert.deepEqual(world.asked, ['start 5', 'load 5']);
  });

  it('tells how far a long weave is, and gives it up for something earlier', async () => {
    const world = new World();
    world.perAsk = 1;
    world.travel.go(1_000);
    await world.hears((line) => line.startsWith('weaving'));
    world.travel.go(3);
    await world.settle();
    assert.ok(world.asked.includes('cancel 1000'), world.asked.join());
    assert.deepEqual(world.told.slice(-2), ['arrived 3', 'rested']);
    assert.ok(!world.told.includes('arrived 1000'));
  });

  it('goes nowhere any more when it is stopped', async () => {
    const world = new World();
    world.perAsk = 1;
    world.travel.go(1_000);
    await new Promise((resolve) => setImmediate(resolve));
    world.travel.stop();
    await world.settle();
    assert.ok(world.asked.includes('cancel 1000'));
    assert.ok(!world.told.some((line) => line.startsWith('arrived')));
  });

  it('tries again while the server is away or busy', async () => {
    for (const trouble of [new Unreachable('away'), new Refused(503, 'busy')]) {
      const world = new World();
      world.trouble = trouble;
      world.travel.go(7);
      await world.hears(() => world.told.length >= 3);
      assert.equal(world.told[2], `failed ${trouble.message} true`);
      assert.ok(world.now >= 3_000, 'ever more slowly');
      world.trouble = null;
      await world.settle();
      assert.deepEqual(world.told.slice(-2), ['arrived 7', 'rested']);
    }
  });

  it('stays where it is when the server refuses, until something else is wanted', async () => {
    const world = new World();
    world.travel.go(4);
    await world.settle();
    world.trouble = new Refused(400, 'no');
    world.travel.go(7);
    await world.settle();
    assert.deepEqual(world.told.slice(2), ['failed no false', 'rested']);
    world.trouble = null;
    world.travel.go(7);
    await world.settle();
    assert.deepEqual(world.told.slice(-2), ['arrived 7', 'rested']);
  });

  it('looks after what is shown, and has it woven again when it is gone', async () => {
    const world = new World();
    world.travel.go(4);
    await world.settle();
    world.lookAfter();
    await world.settle();
    assert.deepEqual(world.asked, ['start 4', 'load 4', 'progress 4']);
    world.forget();
    world.lookAfter();
    await world.settle();
    assert.deepEqual(world.asked.slice(3), ['progress 4', 'start 4', 'load 4']);
    assert.deepEqual(world.told.filter((line) => line === 'arrived 4').length, 2);
  });

  it('loads anew when another layer could not be had', async () => {
    const world = new World();
    world.travel.go(4);
    await world.settle();
    world.failed?.(new Unreachable('away'));
    await world.settle();
    assert.deepEqual(world.told.slice(2), ['failed away true', 'arrived 4', 'rested']);
    world.failed?.(new Refused(500, 'broken'));
    await world.settle();
    assert.deepEqual(world.told.slice(5), ['failed broken false']);
  });

  it('says nothing more when the session is left', async () => {
    const world = new World();
    world.travel.go(4);
    world.leave.abort();
    await world.settle();
    assert.deepEqual(world.told, []);
  });

  it('gives back to the server all but the newest dozen of moments, and these in the end', async () => {
    const world = new World();
    for (let revision = 1; revision <= 14; ++revision) {
      world.travel.go(revision);
      await world.hears((line) => line === `arrived ${revision}`);
    }
    assert.deepEqual(cancelled(world), ['cancel 1', 'cancel 2']);
    world.leave.abort();
    await world.settle();
    assert.equal(cancelled(world).length, 14);
  });
});

function cancelled({ asked }: World): string[] {
  return asked.filter((line) => line.startsWith('cancel'));
}
