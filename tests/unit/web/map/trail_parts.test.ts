import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import type { Point } from '../../../../web/src/api/types';
import { TrailParts } from '../../../../web/src/map/trail_parts';

/** @param positions along x (m) */
function lengthsOf(positions: number[]): number[] {
  const trail = new TrailParts();
  trail.add(positions.map((x): Point => [x, 0]));
  return trail.parts.map((part) => part.length);
}

describe('trail parts', () => {
  it('are not split by a single wrong pose', () => {
    assert.deepEqual(lengthsOf([0, 0.1, 0.2, 0.3, 60, 0.4, 0.5]), [4, 1, 2]);
  });

  it('are one if all steps are long or a stationary robot drives off', () => {
    assert.deepEqual(lengthsOf([0, 3, 6, 10, 13]), [5]);
    assert.deepEqual(lengthsOf([0, 0.2, 0.4, 0.4, 0.4, 0.4, 0.4, 1.9, 3.4]), [9]);
  });

  it('are split where a robot is placed elsewhere and stays there', () => {
    assert.deepEqual(lengthsOf([0, 0.1, 0.2, 20, 20.1, 20.2]), [3, 3]);
  });

  it('are independent of the number of positions added at once', () => {
    const trail = new TrailParts();
    for (const x of [0, 0.1, 0.2, 60, 0.3, 0.4]) trail.add([[x, 0]]);
    assert.deepEqual(
      trail.parts.map((part) => part.length),
      [3, 1, 2],
    );
  });
});
