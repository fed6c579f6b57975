import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import type { Localization } from '../../../../web/src/api/types';
import { needsPlace, qualityOf, wordsOf } from '../../../../web/src/panel/localization';

function tracking(sigma: number, inliers = 0.9): Localization {
  return { state: 'tracking', sigma, inliers, mountError: 0 };
}

describe('the localization of a robot', () => {
  it('is described in words, with the uncertainty of its position', () => {
    assert.equal(wordsOf(tracking(0.001)), 'tracking, \u00b11 cm');
    assert.equal(wordsOf(tracking(0.124)), 'tracking, \u00b112 cm');
    assert.equal(wordsOf(tracking(2.34)), 'tracking, \u00b12.3 m');
    assert.equal(wordsOf(tracking(0.02, 0.554)), 'tracking, \u00b12 cm, 55 % of the scan fits the map');
    assert.equal(wordsOf(tracking(0.3, 0)), 'tracking, \u00b130 cm, 0 % of the scan fits the map');
    assert.equal(wordsOf(tracking(0, 0)), 'tracking, from its first scan on');
    assert.equal(wordsOf({ ...tracking(0.01), state: 'lost' }), 'lost: its scans fit no place');
    assert.equal(wordsOf({ ...tracking(0), state: 'unlocated' }), 'unlocated: its place in the map is not known yet');
  });

  it('says that the mount of the laser is wrong', () => {
    const wrong = { ...tracking(0.001), mountError: -3.1 };
    assert.equal(wordsOf(wrong), 'tracking, \u00b11 cm; the yaw of its laser\u2019s mount seems 178\u00b0 too small');
    assert.equal(qualityOf(wrong), 'bad');
  });

  it('is good only if the position is certain and most of the scan fits the map', () => {
    assert.equal(qualityOf(tracking(0.05)), 'good');
    assert.equal(qualityOf(tracking(0.051)), 'fair');
    assert.equal(qualityOf(tracking(0.01, 0.69)), 'fair');
    assert.equal(qualityOf({ ...tracking(0.01), state: 'unlocated' }), 'fair');
    assert.equal(qualityOf({ ...tracking(0.01), state: 'lost' }), 'bad');
  });

  it('waits for a place only if the server does not know where the robot is', () => {
    assert.equal(needsPlace(tracking(3)), false);
    assert.equal(needsPlace({ ...tracking(0.01), state: 'lost' }), true);
    assert.equal(needsPlace({ ...tracking(0), state: 'unlocated' }), true);
  });
});
