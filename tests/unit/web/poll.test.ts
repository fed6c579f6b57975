import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { backoff } from '../../../web/src/poll';

describe('polling', () => {
  it('keeps its interval without failures', () => {
    assert.equal(backoff(300, 0), 300);
  });

  it('increases the interval with every failure up to a limit', () => {
    assert.deepEqual(
      [1, 2, 3, 10].map((failures) => backoff(300, failures)),
      [600, 1200, 2400, 5000],
    );
  });

  it('never shortens a long interval after failures', () => {
    assert.equal(backoff(15_000, 3), 15_000);
  });
});
