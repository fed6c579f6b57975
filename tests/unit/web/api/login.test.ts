import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { MalformedAnswer } from '../../../../web/src/api/decode';
import { decodeLogin } from '../../../../web/src/api/login';

describe('decoding the login', () => {
  it('decodes a token or null', () => {
    const token = { name: 'kiosk', role: 'viewer', sessions: ['*'] };
    assert.deepEqual(decodeLogin({ needed: true, token }), { needed: true, token: { name: 'kiosk', role: 'viewer' } });
    assert.deepEqual(decodeLogin({ needed: true, token: null }), { needed: true, token: null });
    assert.deepEqual(decodeLogin({ needed: false, token: null }), { needed: false, token: null });
  });

  it('refuses invalid answers', () => {
    assert.throws(() => decodeLogin('hello'), MalformedAnswer);
    assert.throws(() => decodeLogin({ needed: true, token: { role: 'viewer' } }), /token\.name/);
  });
});
