import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { Trails } from '../../../../web/src/live/trails';

describe('trails', () => {
  it('grow by adjacent pieces and know their length', () => {
    const trails = new Trails();
    assert.ok(
      trails.merge('r1', 0, [
        [0, 0],
        [3, 4],
      ]),
    );
    assert.ok(trails.merge('r1', 2, [[3, 5]]));
    assert.deepEqual(trails.get('r1'), {
      points: [
        [0, 0],
        [3, 4],
        [3, 5],
      ],
      length: 6,
    });
  });

  it('contain each point once when pieces overlap', () => {
    const trails = new Trails();
    trails.merge('r1', 0, [
      [0, 0],
      [1, 0],
    ]);
    assert.ok(
      trails.merge('r1', 1, [
        [1, 0],
        [2, 0],
      ]),
    );
    assert.ok(trails.merge('r1', 0, [[0, 0]]));
    assert.deepEqual(trails.get('r1').points, [
      [0, 0],
      [1, 0],
      [2, 0],
    ]);
  });

  it('refuse pieces that are not adjacent', () => {
    const trails = new Trails();
    trails.merge('r1', 0, [[0, 0]]);
    assert.equal(trails.merge('r1', 3, [[3, 0]]), false);
    assert.equal(trails.get('r1').points.length, 1);
    trails.merge('r1', 0, [
      [0, 0],
      [1, 0],
      [2, 0],
    ]);
    assert.ok(trails.merge('r1', 3, [[3, 0]]));
    assert.equal(trails.get('r1').length, 3);
  });

  it('are separate for each robot', () => {
    const trails = new Trails();
    trails.merge('r1', 0, [[0, 0]]);
    assert.deepEqual(trails.get('r2').points, []);
  });
});
