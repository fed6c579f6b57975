import assert from 'node:assert/strict';
import { describe, it, mock } from 'node:test';
import { fetchTrajectory } from '../../../../web/src/api/api';
import { MalformedAnswer } from '../../../../web/src/api/decode';
import { decodeHistory, fetchHistory } from '../../../../web/src/api/history';
import { decodeWeave } from '../../../../web/src/api/weaves';

function trajectory(properties: Record<string, unknown> = {}): unknown {
  const times = { revisions: [3, 5], stamps: [10.5, 11], yaws: [0, 0.1] };
  const geometry = {
    type: 'LineString',
    coordinates: [
      [1, 2],
      [3, 4],
    ],
  };
  const feature = { type: 'Feature', properties: { robot: 'r1', points: 2, ...times, ...properties }, geometry };
  return { type: 'FeatureCollection', revision: 7, features: [feature] };
}

describe('decoding the history', () => {
  it('decodes positions with revisions, stamps and yaws', () => {
    assert.deepEqual(decodeHistory(trajectory()), {
      revision: 7,
      tracks: [
        {
          robot: 'r1',
          points: [
            [1, 2],
            [3, 4],
          ],
          revisions: [3, 5],
          stamps: [10.5, 11],
          yaws: [0, 0.1],
        },
      ],
    });
  });

  it('refuses missing times and times of another length than positions', () => {
    assert.throws(() => decodeHistory(trajectory({ stamps: [1] })), /stamps are not as many/);
    assert.throws(() => decodeHistory(trajectory({ yaws: undefined })), MalformedAnswer);
    assert.throws(() => decodeHistory(trajectory({ revisions: [1, 'x'] })), /revisions\[\] is not a number/);
  });

  it('decodes the progress of a replay job', () => {
    const weave = { id: '0a', state: 'weaving', revision: null, woven: 5, until: { revision: 9, stamp: null } };
    assert.deepEqual(decodeWeave(weave), {
      id: '0a',
      state: 'weaving',
      applied: 5,
      until: 9,
      exclusions: 0,
      reason: '',
    });
    assert.equal(decodeWeave({ ...weave, state: 'failed', reason: 'no room' }).reason, 'no room');
    assert.throws(() => decodeWeave({ ...weave, state: 'dreaming' }), MalformedAnswer);
    assert.throws(() => decodeWeave({ ...weave, until: 9 }), MalformedAnswer);
  });
});

describe('fetching the history', () => {
  it('has the same deadline as fetching trajectories', async () => {
    Object.assign(globalThis, { document: { baseURI: 'http://localhost/' } });
    const requests: string[] = [];
    mock.method(globalThis, 'fetch', ({ pathname, search }: URL) => {
      requests.push(pathname + search);
      return Promise.resolve(Response.json(trajectory()));
    });
    const { mock: deadlines } = mock.method(AbortSignal, 'timeout', () => new AbortController().signal);
    const { signal } = new AbortController();
    await fetchTrajectory('s', 4, signal);
    await fetchHistory('s', 4, signal);
    mock.restoreAll();
    const path = '/api/v1/sessions/s/trajectory.geojson';
    assert.deepEqual(requests, [`${path}?since=4`, `${path}?times=true&since=4`]);
    assert.deepEqual(
      deadlines.calls.map((call) => call.arguments),
      [[120_000], [120_000]],
    );
  });
});
