import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { Refused, Unreachable } from '../../../../web/src/api/http';
import { Draining, troubleOf } from '../../../../web/src/panel/status';

describe('troubleOf', () => {
  it('distinguishes an offline server from a refusal', () => {
    assert.equal(troubleOf(new Unreachable('x')).kind, 'offline');
    assert.equal(troubleOf(new Refused(503, 'x')).kind, 'error');
    assert.match(troubleOf(new Draining()).text, /shutting down/);
  });

  it("contains the server's message", () => {
    assert.match(troubleOf(new Refused(503, 'Store not open: recovering')).text, /Store not open: recovering/);
  });
});
