import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { PbfReader, PbfWriter } from 'pbf';
import { readLiveRequest, writeLiveEvent } from 'virtual:live-protocol';
import { MalformedAnswer } from '../../../../web/src/api/decode';
import { decodeLiveEvent, encodeLiveRequest } from '../../../../web/src/api/live';

type Fields = Parameters<typeof writeLiveEvent>[0];

function bytesOf(fields: Partial<Fields>): ArrayBuffer {
  const writer = new PbfWriter();
  writeLiveEvent(fields, writer);
  return new Uint8Array(writer.finish()).buffer;
}

describe('a live event', () => {
  it('is decoded with all fields', () => {
    const event = decodeLiveEvent(
      bytesOf({
        session: 'id-1',
        revision: 118,
        state: 1,
        counters: { scans: 110 },
        frontiers_revision: 117,
        tiles: [{ layer: 2, everything: false, tiles: [512 * 255 + 256, 512 * 255 + 257], revisions: [118, 2 ** 40] }],
        robots: [
          {
            robot: 3,
            name: 'r1',
            connected: true,
            pose: { x: 2.5, y: 1.25, yaw: 0.5 },
            scan_count: 55,
            trail: [2400, 1250, 100, 0],
            trail_from: 53,
            scan: { origin: { x: 2, y: 1, yaw: 0.5 }, points: [2000, 0, -5, -35] },
          },
        ],
      }),
    );
    assert.equal(event.id, 'id-1');
    assert.deepEqual([event.revision, event.scans, event.frontiersRevision], [118, 110, 117]);
    assert.deepEqual([event.failure, event.draining], [null, false]);
    assert.deepEqual(event.tiles, [
      {
        layer: 'himm',
        everything: false,
        tiles: [
          { z: 9, x: 256, y: 255, revision: 118 },
          { z: 9, x: 257, y: 255, revision: 2 ** 40 },
        ],
      },
    ]);
    const [robot] = event.robots;
    assert.ok(robot);
    assert.deepEqual([robot.index, robot.name, robot.connected, robot.scans, robot.trailFrom], [3, 'r1', true, 55, 53]);
    assert.deepEqual(robot.pose, { x: 2.5, y: 1.25, yaw: 0.5 });
    assert.deepEqual(rounded(robot.trail), [
      [2.4, 1.25],
      [2.5, 1.25],
    ]);
    assert.deepEqual(rounded(robot.scan?.points ?? []), [
      [4, 1],
      [3.995, 0.965],
    ]);
  });

  it('may contain a failure, a shutdown and a robot without a pose', () => {
    const failed = decodeLiveEvent(bytesOf({ state: 2, reason: 'no space left' }));
    assert.equal(failed.failure, 'no space left');
    assert.equal(decodeLiveEvent(bytesOf({ state: 3 })).draining, true);
    const [robot] = decodeLiveEvent(bytesOf({ robots: [{ name: 'new' }] })).robots;
    assert.deepEqual([robot?.pose, robot?.scan, robot?.bodyRadius, robot?.trail], [null, null, null, []]);
  });

  it('may contain how well poses are known, and that earlier ones were corrected', () => {
    const known = (state: number): Fields['robots'] => [
      { name: 'r1', localization: { state, inliers: 0.5, sigma_m: 0.25 } },
    ];
    const event = decodeLiveEvent(bytesOf({ robots: known(1), poses_corrected: 117, moving_scans: 13631 }));
    assert.deepEqual([event.posesCorrected, event.movingScans], [117, 13631]);
    assert.deepEqual(event.robots[0]?.localization, { state: 'tracking', inliers: 0.5, sigma: 0.25, mountError: 0 });
    assert.equal(decodeLiveEvent(bytesOf({ robots: known(2) })).robots[0]?.localization?.state, 'lost');
    assert.equal(decodeLiveEvent(bytesOf({ robots: known(3) })).robots[0]?.localization?.state, 'unlocated');
    assert.equal(decodeLiveEvent(bytesOf({ robots: [{ name: 'r1' }] })).robots[0]?.localization, null);
  });

  it('may contain landmarks or the reason for their refusal', () => {
    const one = { id: 7, x: 1.5, y: -2.25, seen: 3, size_x: 0.5, size_y: 0.25 };
    const event = decodeLiveEvent(bytesOf({ landmarks: { landmarks: [one] } }));
    assert.deepEqual(event.landmarks, {
      landmarks: [{ id: 7, at: [1.5, -2.25], seen: 3, size: [0.5, 0.25] }],
      refused: null,
    });
    const refused = decodeLiveEvent(bytesOf({ landmarks: { refused: 'too many' } }));
    assert.deepEqual(refused.landmarks, { landmarks: [], refused: 'too many' });
    assert.equal(decodeLiveEvent(bytesOf({ revision: 1 })).landmarks, null);
  });

  it('may contain unknown layers', () => {
    assert.deepEqual(decodeLiveEvent(bytesOf({ tiles: [{ layer: 99, tiles: [1], revisions: [1] }] })).tiles, []);
  });

  it('is refused when it is invalid', () => {
    const cut = bytesOf({ robots: [{ name: 'r1', pose: { x: 1, y: 2, yaw: 3 } }] });
    assert.throws(() => decodeLiveEvent(cut.slice(0, cut.byteLength - 3)), MalformedAnswer);
    assert.throws(() => decodeLiveEvent(new Uint8Array([0xff, 0xff, 0xff]).buffer), MalformedAnswer);
    assert.throws(
      () => decodeLiveEvent(bytesOf({ tiles: [{ layer: 1, tiles: [1, 2], revisions: [1] }] })),
      MalformedAnswer,
    );
    assert.throws(() => decodeLiveEvent(bytesOf({ robots: [{ trail: [1, 2, 3] }] })), MalformedAnswer);
  });
});

describe('a live request', () => {
  it('requests tiles of all layers, and scans and landmarks only on demand', () => {
    for (const points of [true, false]) {
      for (const landmarks of [true, false]) {
        const request = readLiveRequest(new PbfReader(encodeLiveRequest({ points, landmarks })));
        assert.deepEqual([...request.layers].sort(), [1, 2, 3, 4]);
        assert.deepEqual([request.points, request.landmarks], [points, landmarks]);
      }
    }
  });
});

function rounded(points: [number, number][]): number[][] {
  return points.map((point) => point.map((value) => Math.round(value * 1e6) / 1e6));
}
