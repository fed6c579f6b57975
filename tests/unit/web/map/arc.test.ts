import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { arcOf } from '../../../../web/src/map/arc';

describe('an arc', () => {
  it('connects its ends and is highest in the middle, on the left', () => {
    const arc = arcOf([1, 2], [11, 2]);
    assert.deepEqual(
      [arc[0], arc.at(-1)],
      [
        [1, 2],
        [11, 2],
      ],
    );
    assert.deepEqual(arc[6], [6, 3.5]);
    assert.ok(arc.every(([, y]) => y >= 2 && y <= 3.5));
    assert.deepEqual(arcOf([11, 2], [1, 2])[6], [6, 0.5]);
  });
});
