import assert from 'node:assert/strict';
import { afterEach, describe, it, mock } from 'node:test';
import { PbfWriter } from 'pbf';
import { writeLiveEvent } from 'virtual:live-protocol';
import type { Point } from '../../../../web/src/api/types';
import { Feed } from '../../../../web/src/live/feed';
import type { Trails } from '../../../../web/src/live/trails';
import { retryNow } from '../../../../web/src/poll';

/** The page's newest connection. */
let socket: FakeSocket;

class FakeSocket extends EventTarget {
  static readonly OPEN = 1;
  readyState = FakeSocket.OPEN;

  constructor() {
    super();
    socket = this;
    queueMicrotask(() => this.dispatchEvent(new Event('open')));
  }

  send(): void {}

  close(): void {
    this.readyState = 3;
  }

  /** Sends an event of a robot with this many places; the event contains the newest one. */
  sendEvent(session: string, places: number, posesCorrected = 0): void {
    const writer = new PbfWriter();
    const robots = [{ name: 'r1', trail: [1000 * places, 0], trail_from: places - 1 }];
    writeLiveEvent({ session, revision: places, robots, poses_corrected: posesCorrected }, writer);
    this.dispatchEvent(Object.assign(new Event('message'), { data: new Uint8Array(writer.finish()).buffer }));
  }
}

/** A server with one session; the test decides when it answers path requests. */
class World {
  id = 'first';
  /** Revisions after which paths were requested. */
  readonly requests: string[] = [];
  readonly trails: Trails[] = [];
  readonly corrected: Trails[] = [];
  filled = 0;
  opened = 0;
  private readonly leave = new AbortController();
  private readonly answers: ((places: number) => void)[] = [];

  constructor() {
    const document = Object.assign(new EventTarget(), { baseURI: 'http://localhost/', hidden: false });
    Object.assign(globalThis, { document, window: new EventTarget(), WebSocket: FakeSocket });
    mock.method(globalThis, 'fetch', (url: URL) => this.answer(url));
    const ignore = (): void => {};
    const started = (_: unknown, trails: Trails): void => void this.trails.push(trails);
    const corrected = (trails: Trails): void => void this.corrected.push(trails);
    const [opened, trails] = [(): void => void ++this.opened, (): void => void ++this.filled];
    const events = { started, opened, event: ignore, tiles: ignore, trails, corrected, gone: ignore, settled: ignore };
    new Feed('map', events, this.leave.signal).run();
  }

  /** Answers the n-th request for paths. */
  answerPaths(n: number, places: number): void {
    this.answers[n]?.(places);
  }

  end(): void {
    this.leave.abort();
    mock.restoreAll();
  }

  private answer({ pathname, searchParams }: URL): Promise<Response> {
    if (!pathname.endsWith('trajectory.geojson')) {
      const config = { cell_size: 0.05 };
      const counters = { revision: 9, scans: 9, bounds: null, robots: [] };
      return Promise.resolve(Response.json({ name: 'map', id: this.id, created: '', number: 1, config, ...counters }));
    }
    this.requests.push(searchParams.get('since') ?? '');
    return new Promise((resolve) => this.answers.push((places) => resolve(Response.json(pathOf(places)))));
  }
}

function pointsOf(places: number): Point[] {
  return Array.from({ length: places }, (_, n): Point => [n + 1, 0]);
}

function pathOf(places: number): unknown {
  const geometry = { type: 'LineString', coordinates: pointsOf(places) };
  return { revision: places, features: [{ type: 'Feature', properties: { robot: 'r1', points: places }, geometry }] };
}

/** Runs pending tasks until the condition holds. */
async function until(reached: () => boolean): Promise<void> {
  for (let turn = 0; !reached(); ++turn) {
    assert.ok(turn < 10_000, `condition never holds: ${reached.toString()}`);
    await new Promise((resolve) => setImmediate(resolve));
  }
}

describe('a feed', () => {
  let world: World;

  afterEach(() => world.end());

  it('fetches the beginning of a trail that events omit', async () => {
    world = new World();
    await until(() => world.opened === 1);
    socket.sendEvent('first', 9);
    await until(() => world.requests.length === 1);
    world.answerPaths(0, 9);
    await until(() => world.filled === 1);
    assert.deepEqual(world.trails[0]?.get('r1').points, pointsOf(9));
  });

  it('separates the paths of a session and of its recreation under the same name', async () => {
    world = new World();
    await until(() => world.opened === 1);
    socket.sendEvent('first', 9);
    await until(() => world.requests.length === 1);
    world.id = 'second';
    socket.sendEvent('second', 5);
    await until(() => {
      retryNow();
      return world.opened === 2;
    });
    socket.sendEvent('second', 5);
    await until(() => world.requests.length === 2);
    // The answer for the first session is outdated when it arrives; the answer for the second is still pending.
    world.answerPaths(0, 7);
    for (let n = 0; n < 10; ++n) await new Promise((resolve) => setImmediate(resolve));
    socket.sendEvent('second', 6);
    assert.deepEqual([world.requests, world.filled], [['0', '0'], 0]);
    world.answerPaths(1, 6);
    await until(() => world.filled === 1);
    assert.deepEqual(world.requests, ['0', '0']);
    assert.deepEqual(world.trails[1]?.get('r1').points, pointsOf(6));
    assert.deepEqual(world.trails[0]?.get('r1').points, []);
  });

  it('keeps the trails until those with corrected poses are complete', async () => {
    world = new World();
    await until(() => world.opened === 1);
    socket.sendEvent('first', 1);
    socket.sendEvent('first', 2);
    assert.deepEqual([world.requests, world.corrected], [[], []]);
    socket.sendEvent('first', 9, 8);
    await until(() => world.requests.length === 1);
    assert.deepEqual([world.requests, world.corrected], [['0'], []]);
    assert.deepEqual(world.trails[0]?.get('r1').points, pointsOf(2));
    world.answerPaths(0, 9);
    await until(() => world.filled === 1);
    assert.deepEqual(world.corrected[0]?.get('r1').points, pointsOf(9));
    socket.sendEvent('first', 10, 8);
    assert.deepEqual(world.corrected[0]?.get('r1').points, pointsOf(10));
    assert.deepEqual([world.requests, world.corrected.length], [['0'], 1]);
  });
});
