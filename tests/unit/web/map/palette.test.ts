import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { colourise, colourTable } from '../../../../web/src/map/palette';

const kTable = colourTable({ free: [250, 251, 252], occupied: [10, 20, 30] });

function coloured(level: number): number[] {
  const pixels = new Uint8ClampedArray([level, level, level, 255]);
  colourise(pixels, kTable);
  return [...pixels];
}

describe('the palette', () => {
  it('lets the page show through what is unknown', () => {
    assert.equal(coloured(128)[3], 0);
  });

  it('gives sure cells their full colour', () => {
    assert.deepEqual(coloured(0), [10, 20, 30, 255]);
    assert.deepEqual(coloured(255), [250, 251, 252, 255]);
  });

  it('grows more opaque the surer a cell is, on both sides', () => {
    for (let level = 1; level < 128; ++level) assert.ok((coloured(level)[3] ?? 0) <= (coloured(level - 1)[3] ?? 0));
    for (let level = 129; level < 256; ++level) assert.ok((coloured(level)[3] ?? 0) >= (coloured(level - 1)[3] ?? 0));
  });
});
