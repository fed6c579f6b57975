import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { valueOf } from '../../../../web/src/layers/cell_value';

describe('cell code', () => {
  it('is a percentage, a counter or a class, depending on the layer', () => {
    assert.deepEqual(valueOf('occupancy', 83), { kind: 'percent', percent: 83 });
    assert.deepEqual(valueOf('sonar', 0), { kind: 'percent', percent: 0 });
    assert.deepEqual(valueOf('himm', 15), { kind: 'counter', count: 15 });
    assert.deepEqual(valueOf('classification', 4), { kind: 'class', name: 'danger' });
  });

  it('marks unknown cells', () => {
    for (const layer of ['occupancy', 'sonar', 'himm'] as const) assert.equal(valueOf(layer, 255).kind, 'unknown');
    assert.deepEqual(valueOf('classification', 0), { kind: 'class', name: 'unexplored' });
    assert.deepEqual(valueOf('classification', 77), { kind: 'class', name: 'unexplored' });
  });
});
