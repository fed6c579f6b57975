import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { MalformedAnswer } from '../../../../web/src/api/decode';
import { decodePoseGraph } from '../../../../web/src/api/pose_graph';

const kLine = {
  type: 'LineString',
  coordinates: [
    [1, 2],
    [3, 4],
  ],
};

describe('a pose graph', () => {
  it('has keyframes and edges', () => {
    const features = [
      { properties: { kind: 'keyframe' }, geometry: { type: 'Point', coordinates: [1, 2] } },
      { properties: { kind: 'odometry', is_used: true }, geometry: kLine },
      { properties: { kind: 'loop', is_used: false }, geometry: kLine },
    ];
    const ends = { from: [1, 2], to: [3, 4] };
    assert.deepEqual(decodePoseGraph({ features }), {
      keyframes: [[1, 2]],
      edges: [
        { ...ends, isLoop: false, isUsed: true },
        { ...ends, isLoop: true, isUsed: false },
      ],
    });
  });

  it('is refused if an edge has one end', () => {
    const features = [{ properties: { kind: 'match' }, geometry: { type: 'LineString', coordinates: [[1, 2]] } }];
    assert.throws(() => decodePoseGraph({ features }), MalformedAnswer);
  });
});
