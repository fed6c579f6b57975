import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { MalformedAnswer } from '../../../../web/src/api/decode';
import { isPassing, Refused, Unreachable } from '../../../../web/src/api/http';

describe('isPassing', () => {
  it('is true without an answer and for answers that ask for a retry', () => {
    assert.ok(isPassing(new Unreachable('x')));
    for (const status of [408, 429, 503]) assert.ok(isPassing(new Refused(status, 'x')), String(status));
  });

  it('is false for other errors', () => {
    for (const status of [400, 401, 404, 500]) assert.ok(!isPassing(new Refused(status, 'x')), String(status));
    assert.ok(!isPassing(new MalformedAnswer('x')));
    assert.ok(!isPassing(new TypeError('x')));
  });
});
