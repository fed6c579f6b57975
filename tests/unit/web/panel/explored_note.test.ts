import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { exploredText } from '../../../../web/src/panel/explored_note';

describe('the explored note', () => {
  it('lists one, some or many robots', () => {
    assert.equal(exploredText([]), '');
    assert.equal(exploredText(['r1']), 'r1 has explored all it can reach.');
    assert.equal(exploredText(['a', 'b']), 'a and b have explored all they can reach.');
    assert.equal(exploredText(['a', 'b', 'c']), 'a, b and c have explored all they can reach.');
    assert.equal(exploredText(['a', 'b', 'c', 'd', 'e']), 'a, b, c and 2 more have explored all they can reach.');
  });
});
