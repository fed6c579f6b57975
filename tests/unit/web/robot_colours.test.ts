import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { RobotColours } from '../../../web/src/robot_colours';

describe('robot colours', () => {
  it('do not change when other robots join', () => {
    const colours = new RobotColours(2);
    assert.deepEqual(
      ['b', 'a', 'b', 'c'].map((name) => colours.indexOf(name)),
      [0, 1, 0, 0],
    );
  });
});
