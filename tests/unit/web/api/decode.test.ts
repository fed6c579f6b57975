import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import {
  decodeChanges,
  decodeRobotPort,
  decodeSession,
  decodeSessionPage,
  decodeTrajectory,
  MalformedAnswer,
} from '../../../../web/src/api/decode';

function session(): Record<string, unknown> {
  return {
    name: 'intel',
    id: '000000000000002a',
    created: '2026-11-21T09:00:00Z',
    number: 7,
    revision: 911,
    exclusions: 100,
    scans: 910,
    moving_scans: 13,
    localize_only: true,
    config: { cell_size: 0.05, p_occupied: 0.9 },
    layers: ['occupancy'],
    bounds: { min_x: -20.1, min_y: -3.2, max_x: 450, max_y: 30 },
    main_bounds: { min_x: -20.1, min_y: -3.2, max_x: 18, max_y: 30 },
    robots: [
      {
        ...{ name: 'r1', connected: true, scans: 910, last_seq: 910, stamp: 1.5, pose: { x: 1, y: 2, yaw: 0.1 } },
        localization: {
          poses: 'odometry',
          state: 'lost',
          inliers: 0.5,
          sigma_m: 0.25,
          sigma_rad: 0.1,
          mount_yaw_error: 3,
        },
      },
    ],
  };
}

describe('decoding', () => {
  it('decodes a session of the server', () => {
    assert.deepEqual(decodeSession(session()), {
      name: 'intel',
      id: '000000000000002a',
      created: '2026-11-21T09:00:00Z',
      number: 7,
      revision: 911,
      exclusions: 100,
      scans: 910,
      movingScans: 13,
      isLocalizeOnly: true,
      cellSize: 0.05,
      config: { cell_size: 0.05, p_occupied: 0.9 },
      bounds: { minX: -20.1, minY: -3.2, maxX: 450, maxY: 30 },
      mainBounds: { minX: -20.1, minY: -3.2, maxX: 18, maxY: 30 },
      robots: [
        {
          ...{ name: 'r1', connected: true, scans: 910, pose: { x: 1, y: 2, yaw: 0.1 }, bodyRadius: null },
          localization: { state: 'lost', inliers: 0.5, sigma: 0.25, mountError: 3 },
        },
      ],
      failure: null,
    });
  });

  it('contains the reason why a session accepts no scans', () => {
    const failed = { ...session(), state: 'failed', reason: 'no space left' };
    const page = decodeSessionPage({ sessions: [failed], next: null });
    assert.deepEqual(page.damaged, []);
    assert.equal(page.sessions[0]?.failure, 'no space left');
    assert.throws(() => decodeSession({ ...session(), state: 'failed' }), /reason is not a text/);
  });

  it('separates damaged sessions from served ones', () => {
    const page = decodeSessionPage({
      sessions: [
        { name: '#000000000000002a', state: 'damaged', reason: 'no record' },
        { ...session(), state: 'ok' },
      ],
      next: null,
    });
    assert.deepEqual(page.damaged, [{ name: '#000000000000002a', reason: 'no record' }]);
    assert.deepEqual(
      page.sessions.map(({ name }) => name),
      ['intel'],
    );
  });

  it('decodes the robot port', () => {
    const robots = { host: '192.0.2.7', port: 7447 };
    assert.deepEqual(decodeRobotPort({ status: 'ready', robots, damaged: [] }), robots);
    assert.deepEqual(decodeRobotPort({ robots: { host: null, port: 1 } }), { host: null, port: 1 });
    assert.throws(() => decodeRobotPort({ status: 'ready' }), MalformedAnswer);
  });

  it('accepts a session without scans', () => {
    const empty = decodeSession({
      ...session(),
      bounds: null,
      main_bounds: null,
      robots: [{ name: 'r', scans: 0, pose: null, localization: { poses: 'map', state: 'given' } }],
    });
    assert.equal(empty.bounds, null);
    assert.equal(empty.mainBounds, null);
    const robot = { name: 'r', connected: false, scans: 0, pose: null, bodyRadius: null, localization: null };
    assert.deepEqual(empty.robots, [robot]);
  });

  it('takes a session of a server without localize-only mode as one that maps', () => {
    const { localize_only: _, ...earlier } = session();
    assert.equal(decodeSession(earlier).isLocalizeOnly, false);
  });

  it('names the invalid field', () => {
    const broken: [unknown, RegExp][] = [
      [null, /session is not an object/],
      [{ ...session(), name: 7 }, /name is not a text/],
      [{ ...session(), revision: '911' }, /revision is not a number/],
      [{ ...session(), config: { cell_size: 0 } }, /config.cell_size is not positive/],
      [{ ...session(), robots: {} }, /robots is not a list/],
      [{ ...session(), robots: [{ name: 'r', scans: 1, pose: { x: 1 } }] }, /pose.y is not a number/],
    ];
    for (const [json, message] of broken) assert.throws(() => decodeSession(json), message);
    assert.throws(() => decodeSessionPage([]), MalformedAnswer);
    assert.throws(() => decodeChanges({ revision: 1, tiles: [{ z: 9, x: 1, y: 1 }] }), /tiles\[\].revision/);
  });

  it('decodes trajectories of one point and lines', () => {
    const feature = (type: string, coordinates: number[][]): unknown => ({
      type: 'Feature',
      id: 'r1',
      properties: { robot: 'r1', points: coordinates.length },
      geometry: { type, coordinates },
    });
    for (const [type, coordinates] of [
      ['MultiPoint', [[1, 2]]],
      [
        'LineString',
        [
          [1, 2],
          [3, 4],
        ],
      ],
    ] as const) {
      const json = { revision: 3, features: [feature(type, coordinates as unknown as number[][])] };
      assert.deepEqual(decodeTrajectory(json), { revision: 3, tracks: [{ robot: 'r1', points: coordinates }] });
    }
  });
});
