import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { MalformedAnswer } from '../../../../web/src/api/decode';
import { isPassing, Refused, Unreachable } from '../../../../web/src/api/http';

describe('what went wrong', () => {
  it('may be mended by waiting when nobody answered, or the answer says so', () => {
    assert.ok(isPassing(new Unreachable('x')));
    for (const status of [408, 429, 503]) assert.ok(isPassing(new Refused(status, 'x')), String(status));
  });

  it('stays as it is otherwise', () => {
    for (const status of [400, 401, 404, 500]) assert.ok(!isPassing(new Refused(status, 'x')), String(status));
    assert.ok(!isPassing(new MalformedAnswer('x')));
    assert.ok(!isPassing(new TypeError('x')));
  });
});
