import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { backoff } from '../../../web/src/poll';

describe('polling', () => {
  it('keeps its pace while all is well', () => {
    assert.equal(backoff(300, 0), 300);
  });

  it('slows down with every failure, but stays ready to come back', () => {
    assert.deepEqual(
      [1, 2, 3, 10].map((failures) => backoff(300, failures)),
      [600, 1200, 2400, 5000],
    );
  });

  it('is not hurried by failures when it is slow anyway', () => {
    assert.equal(backoff(15_000, 3), 15_000);
  });
});
