import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import type { Session } from '../../../../web/src/api/types';
import { SessionRates } from '../../../../web/src/sessions/rates';

function session(scans: number, id = '1', name = 'a'): Session {
  return {
    name,
    id,
    created: '',
    number: 1,
    revision: scans,
    exclusions: 0,
    scans,
    movingScans: 0,
    isLocalizeOnly: false,
    cellSize: 0.05,
    config: {},
    bounds: null,
    mainBounds: null,
    robots: [],
    failure: null,
  };
}

describe('session rate', () => {
  it('is unknown after one answer', () => {
    const rates = new SessionRates();
    assert.equal(rates.of('a'), null);
    rates.learn([session(100)], 0);
    assert.equal(rates.of('a'), null);
  });

  it('is scans per second', () => {
    const rates = new SessionRates();
    rates.learn([session(100)], 1000);
    rates.learn([session(130)], 3000);
    assert.equal(rates.of('a'), 15);
  });

  it('uses only the last seconds', () => {
    const rates = new SessionRates();
    for (let second = 0; second <= 10; second += 2) rates.learn([session(second * 50)], second * 1000);
    assert.equal(rates.of('a'), 50);
    for (let second = 12; second <= 20; second += 2) rates.learn([session(500)], second * 1000);
    assert.equal(rates.of('a'), 0);
  });

  it('is never negative: an outdated answer and a recreated session restart it', () => {
    const rates = new SessionRates();
    rates.learn([session(100)], 0);
    rates.learn([session(90)], 2000);
    assert.equal(rates.of('a'), null);
    rates.learn([session(94)], 4000);
    assert.equal(rates.of('a'), 2);
    rates.learn([session(200, '2')], 6000);
    assert.equal(rates.of('a'), null);
  });

  it('is removed with its session', () => {
    const rates = new SessionRates();
    rates.learn([session(1), session(5, '2', 'b')], 0);
    rates.learn([session(5, '2', 'b')], 2000);
    rates.learn([session(9), session(5, '2', 'b')], 4000);
    assert.equal(rates.of('a'), null);
    assert.equal(rates.of('b'), 0);
  });
});
