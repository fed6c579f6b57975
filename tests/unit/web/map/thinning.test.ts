import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { thin } from '../../../../web/src/map/thinning';

const kThings = [
  { id: 1, at: [0.1, 0.1], weight: 2 },
  { id: 2, at: [0.9, 0.9], weight: 5 },
  { id: 3, at: [0.5, 0.5], weight: 5 },
  { id: 4, at: [-0.1, 0.1], weight: 1 },
] satisfies { id: number; at: [number, number]; weight: number }[];

describe('thinning', () => {
  it('keeps the item of the highest weight per square, independent of order', () => {
    assert.deepEqual([...thin(kThings, 1)].sort(), [2, 4]);
    assert.deepEqual([...thin([...kThings].reverse(), 1)].sort(), [2, 4]);
  });

  it('keeps all items when the squares are small', () => {
    assert.equal(thin(kThings, 0.01).size, 4);
  });
});
