import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { Refused, Unreachable } from '../../../../web/src/api/http';
import type { Weave } from '../../../../web/src/api/weaves';
import { LiveSource, type MapSource } from '../../../../web/src/map/map_source';
import { TimeTravel } from '../../../../web/src/time/time_travel';

const kKeepMs = 10_000;

/** A server that replays `perRequest` entries between two requests, and a clock that advances during waits. */
class World {
  readonly requests: string[] = [];
  readonly events: string[] = [];
  readonly leave = new AbortController();
  perRequest = Infinity;
  now = 0;
  trouble: Error | null = null;
  failed: ((error: unknown) => void) | null = null;
  private readonly replayed = new Map<string, number>();
  private readonly keepers: (() => void)[] = [];
  readonly travel: TimeTravel;

  constructor() {
    const source: MapSource = new LiveSource({ name: 's', id: '1' }, 0.05, 'own');
    this.travel = new TimeTravel(
      {
        start: async (revision) => {
          this.requests.push(`start ${revision}`);
          if (this.trouble) throw this.trouble;
          this.replayed.set(
            String(revision),
            this.replayed.get(String(revision)) ?? Math.min(revision, this.perRequest),
          );
          return this.weave(String(revision));
        },
        progress: async (id) => {
          this.requests.push(`progress ${id}`);
          if (this.trouble) throw this.trouble;
          if (!this.replayed.has(id)) throw new Refused(404, 'no such weave');
          this.replayed.set(id, Math.min(Number(id), (this.replayed.get(id) ?? 0) + this.perRequest));
          return this.weave(id);
        },
        cancel: async (id) => void this.requests.push(`cancel ${id}`),
        load: async (id, failed) => {
          this.requests.push(`load ${id}`);
          this.failed = failed;
          return source;
        },
      },
      {
        arrived: (revision) => this.events.push(`arrived ${revision}`),
        weaving: (woven, until) => this.events.push(`weaving ${woven}/${until}`),
        failed: (error, trying) => this.events.push(`failed ${(error as Error).message} ${trying}`),
        rested: () => this.events.push('rested'),
      },
      this.leave.signal,
      {
        now: () => this.now,
        rest: (durationMs) => {
          // The check of the shown replay job waits until the test calls checkShown().
          if (durationMs === kKeepMs) return new Promise((resolve) => this.keepers.push(resolve));
          this.now += durationMs;
          return new Promise((resolve) => setImmediate(resolve));
        },
      },
    );
  }

  checkShown(): void {
    for (const keeper of this.keepers.splice(0)) keeper();
  }

  forget(): void {
    this.replayed.clear();
  }

  async settle(): Promise<void> {
    for (let turn = 0; turn < 200; ++turn) await new Promise((resolve) => setImmediate(resolve));
  }

  /** Waits for an expected event, with an upper bound. */
  async waitFor(expected: (line: string) => boolean): Promise<void> {
    for (let turn = 0; turn < 2_000 && !this.events.some(expected); ++turn) {
      await new Promise((resolve) => setImmediate(resolve));
    }
    assert.ok(this.events.some(expected), this.events.join());
  }

  private weave(id: string): Weave {
    const applied = this.replayed.get(id) ?? 0;
    return {
      id,
      state: applied < Number(id) ? 'weaving' : 'done',
      applied,
      until: Number(id),
      exclusions: 0,
      reason: '',
    };
  }
}

describe('travelling in time', () => {
  it('starts a replay job, waits until it is done and loads it', async () => {
    const world = new World();
    world.perRequest = 10;
    world.travel.go(25);
    await world.settle();
    assert.deepEqual(world.requests, ['start 25', 'progress 25', 'progress 25', 'load 25']);
    assert.deepEqual(world.events, ['arrived 25', 'rested']);
  });

  it('runs one replay job at a time and continues with the newest request', async () => {
    const world = new World();
    for (let revision = 1; revision <= 50; ++revision) world.travel.go(revision);
    await world.settle();
    assert.deepEqual(world.requests, ['start 1', 'load 1', 'start 50', 'load 50']);
    assert.deepEqual(world.events, ['arrived 1', 'arrived 50', 'rested']);
  });

  it('makes no request for the current revision', async () => {
    const world = new World();
    world.travel.go(5);
    await world.settle();
    world.travel.go(5);
    await world.settle();
    assert.deepEqual(world.requests, ['start 5', 'load 5']);
  });

  it('requests the shown revision again after its requests have changed', async () => {
    const world = new World();
    world.travel.go(5);
    await world.settle();
    world.travel.invalidate();
    world.travel.go(5);
    await world.settle();
    assert.deepEqual(world.requests, ['start 5', 'load 5', 'start 5', 'load 5']);
    assert.deepEqual(world.events, ['arrived 5', 'rested', 'arrived 5', 'rested']);
  });

  it('does not arrive with a replay job of an earlier kind of request', async () => {
    const world = new World();
    world.perRequest = 1;
    world.travel.go(1_000);
    await world.waitFor((line) => line.startsWith('weaving'));
    world.travel.invalidate();
    world.travel.go(1_000);
    await world.settle();
    world.perRequest = Infinity;
    await world.settle();
    assert.deepEqual(cancelled(world), ['cancel 1000']);
    assert.equal(world.requests.filter((line) => line === 'start 1000').length, 2);
    assert.deepEqual(world.events.slice(-2), ['arrived 1000', 'rested']);
  });

  it('reports the progress of a long replay job and cancels it for an earlier revision', async () => {
    const world = new World();
    world.perRequest = 1;
    world.travel.go(1_000);
    await world.waitFor((line) => line.startsWith('weaving'));
    world.travel.go(3);
    await world.settle();
    assert.ok(world.requests.includes('cancel 1000'), world.requests.join());
    assert.deepEqual(world.events.slice(-2), ['arrived 3', 'rested']);
    assert.ok(!world.events.includes('arrived 1000'));
  });

  it('does not arrive after stop()', async () => {
    const world = new World();
    world.perRequest = 1;
    world.travel.go(1_000);
    await new Promise((resolve) => setImmediate(resolve));
    world.travel.stop();
    await world.settle();
    assert.ok(world.requests.includes('cancel 1000'));
    assert.ok(!world.events.some((line) => line.startsWith('arrived')));
  });

  it('retries while the server is offline or busy', async () => {
    for (const trouble of [new Unreachable('away'), new Refused(503, 'busy')]) {
      const world = new World();
      world.trouble = trouble;
      world.travel.go(7);
      await world.waitFor(() => world.events.length >= 3);
      assert.equal(world.events[2], `failed ${trouble.message} true`);
      assert.ok(world.now >= 3_000, 'the delays must increase');
      world.trouble = null;
      await world.settle();
      assert.deepEqual(world.events.slice(-2), ['arrived 7', 'rested']);
    }
  });

  it('stays at its revision after a refusal until the next request', async () => {
    const world = new World();
    world.travel.go(4);
    await world.settle();
    world.trouble = new Refused(400, 'no');
    world.travel.go(7);
    await world.settle();
    assert.deepEqual(world.events.slice(2), ['failed no false', 'rested']);
    world.trouble = null;
    world.travel.go(7);
    await world.settle();
    assert.deepEqual(world.events.slice(-2), ['arrived 7', 'rested']);
  });

  it('checks the shown replay job and starts it again when it is gone', async () => {
    const world = new World();
    world.travel.go(4);
    await world.settle();
    world.checkShown();
    await world.settle();
    assert.deepEqual(world.requests, ['start 4', 'load 4', 'progress 4']);
    world.forget();
    world.checkShown();
    await world.settle();
    assert.deepEqual(world.requests.slice(3), ['progress 4', 'start 4', 'load 4']);
    assert.deepEqual(world.events.filter((line) => line === 'arrived 4').length, 2);
  });

  it('reloads when another layer fails', async () => {
    const world = new World();
    world.travel.go(4);
    await world.settle();
    world.failed?.(new Unreachable('away'));
    await world.settle();
    assert.deepEqual(world.events.slice(2), ['failed away true', 'arrived 4', 'rested']);
    world.failed?.(new Refused(500, 'broken'));
    await world.settle();
    assert.deepEqual(world.events.slice(5), ['failed broken false']);
  });

  it('reports nothing after the session is left', async () => {
    const world = new World();
    world.travel.go(4);
    world.leave.abort();
    await world.settle();
    assert.deepEqual(world.events, []);
  });

  it('cancels all but the newest twelve replay jobs, and these at the end', async () => {
    const world = new World();
    for (let revision = 1; revision <= 14; ++revision) {
      world.travel.go(revision);
      await world.waitFor((line) => line === `arrived ${revision}`);
    }
    assert.deepEqual(cancelled(world), ['cancel 1', 'cancel 2']);
    world.leave.abort();
    await world.settle();
    assert.equal(cancelled(world).length, 14);
  });
});

function cancelled({ requests }: World): string[] {
  return requests.filter((line) => line.startsWith('cancel'));
}
