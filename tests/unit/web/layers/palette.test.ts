import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import type { LayerName } from '../../../../web/src/layers/layers';
import { colourise, colourTable, counterColour, type Palette } from '../../../../web/src/layers/palette';

const kPalette: Palette = {
  free: [250, 251, 252],
  occupied: [10, 20, 30],
  counters: [
    [0, 0, 0],
    [50, 60, 70],
    [100, 110, 120],
    [200, 210, 220],
  ],
  classes: { free: [1, 1, 1], occupied: [2, 2, 2], frontier: [3, 3, 3], danger: [4, 4, 4] },
};

/** @param pixel red, green, blue as drawn by the server */
function coloured(layer: LayerName, ...pixel: number[]): number[] {
  const pixels = new Uint8ClampedArray([...pixel, 255]);
  colourise(pixels, colourTable(layer, kPalette));
  return [...pixels];
}

function ofLevel(level: number): number[] {
  return coloured('occupancy', level, level, level);
}

describe('the palette', () => {
  it('makes unknown cells transparent in every layer', () => {
    for (const layer of ['occupancy', 'sonar', 'himm', 'classification'] as const) {
      assert.equal(coloured(layer, 128, 128, 128)[3], 0, layer);
    }
  });

  it('gives certain cells their full colour', () => {
    assert.deepEqual(ofLevel(0), [10, 20, 30, 255]);
    assert.deepEqual(ofLevel(255), [250, 251, 252, 255]);
  });

  it('increases opacity with certainty in both directions', () => {
    for (let level = 1; level < 128; ++level) assert.ok((ofLevel(level)[3] ?? 0) <= (ofLevel(level - 1)[3] ?? 0));
    for (let level = 129; level < 256; ++level) assert.ok((ofLevel(level)[3] ?? 0) >= (ofLevel(level - 1)[3] ?? 0));
  });

  it("identifies each class by the server's colour", () => {
    assert.deepEqual(coloured('classification', 255, 249, 214), [1, 1, 1, 255]);
    assert.deepEqual(coloured('classification', 67, 40, 24), [2, 2, 2, 255]);
    assert.deepEqual(coloured('classification', 46, 160, 67), [3, 3, 3, 255]);
    assert.deepEqual(coloured('classification', 217, 72, 56), [4, 4, 4, 255]);
  });

  it("colours counters by the server's shades", () => {
    assert.deepEqual(coloured('himm', 255, 255, 255), [0, 0, 0, 255]);
    assert.deepEqual(coloured('himm', 0, 0, 0), [200, 210, 220, 255]);
    assert.deepEqual(coloured('himm', 170, 170, 170), [50, 60, 70, 255]);
    assert.deepEqual(counterColour(kPalette, 1), [10, 12, 14]);
    assert.deepEqual(counterColour(kPalette, 15), [200, 210, 220]);
  });
});
