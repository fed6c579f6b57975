import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { scaleStep } from '../../../../web/src/map/scale';

describe('the scale bar', () => {
  it('uses the longest round length that fits', () => {
    assert.deepEqual(scaleStep(0.05, 120), { metres: 5, pixels: 100 });
    assert.deepEqual(scaleStep(1, 120), { metres: 100, pixels: 100 });
  });

  it('is between two fifths of the limit and the limit', () => {
    for (let resolution = 0.0011; resolution < 100; resolution *= 1.07) {
      const { metres, pixels } = scaleStep(resolution, 120);
      assert.ok(pixels <= 120.001 && pixels >= 47.9, `${pixels} pixels at ${resolution}`);
      assert.match(metres.toExponential(6), /^[125]\.0/);
    }
  });
});
