import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { hashOfSession, hashWithLayer, layerOfHash, sessionOfHash } from '../../../web/src/address';

describe('the address hash', () => {
  it('returns any session name that it contains', () => {
    for (const name of ['intel', 'a_b-1', '<b>&#=+ %\u00e9']) assert.equal(sessionOfHash(hashOfSession(name)), name);
  });

  it('selects no session when it contains none', () => {
    for (const hash of ['', '#', '#session=', '#other=1']) assert.equal(sessionOfHash(hash), null);
  });

  it('contains the layer next to the session, unless it is the default', () => {
    const hash = hashWithLayer(hashOfSession('a b'), 'himm');
    assert.equal(layerOfHash(hash), 'himm');
    assert.equal(sessionOfHash(hash), 'a b');
    assert.equal(hashWithLayer(hash, 'occupancy'), hashOfSession('a b'));
    assert.equal(layerOfHash('#session=a&layer=<b>'), null);
    assert.equal(layerOfHash('#session=a'), null);
  });
});
