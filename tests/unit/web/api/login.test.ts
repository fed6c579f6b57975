import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { MalformedAnswer } from '../../../../web/src/api/decode';
import { decodeLogin } from '../../../../web/src/api/login';

describe('decoding who is signed in', () => {
  it('reads the token, or that there is none', () => {
    const token = { name: 'kiosk', role: 'viewer', sessions: ['*'] };
    assert.deepEqual(decodeLogin({ needed: true, token }), { needed: true, token: { name: 'kiosk', role: 'viewer' } });
    assert.deepEqual(decodeLogin({ needed: true, token: null }), { needed: true, token: null });
    assert.deepEqual(decodeLogin({ needed: false, token: null }), { needed: false, token: null });
  });

  it('refuses what is no answer of this server', () => {
    assert.throws(() => decodeLogin('hello'), MalformedAnswer);
    assert.throws(() => decodeLogin({ needed: true, token: { role: 'viewer' } }), /token\.name/);
  });
});
