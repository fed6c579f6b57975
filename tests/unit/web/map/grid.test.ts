import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { cellAt, placeOfCell, squareExtent, tileResolutions } from '../../../../web/src/map/grid';

describe('the grid', () => {
  it('is a square of 256 * 2^9 cells centred on the origin', () => {
    assert.deepEqual(squareExtent(0.5), [-32768, -32768, 32768, 32768]);
  });

  it('shows one cell per pixel at zoom 9 and doubles towards zoom 0', () => {
    const resolutions = tileResolutions(0.05);
    assert.equal(resolutions.length, 10);
    assert.equal(resolutions[9], 0.05);
    assert.equal(resolutions[0], 0.05 * 512);
  });

  it('counts cells downwards from the origin too', () => {
    assert.deepEqual(cellAt(0.01, -0.01, 0.05), { i: 0, j: -1 });
    assert.deepEqual(cellAt(-12.3, 7.5, 0.25), { i: -50, j: 30 });
  });

  it('maps the cell above and right of the origin to the bottom left of tile (256, 255)', () => {
    assert.deepEqual(placeOfCell({ i: 0, j: 0 }), { x: 256, y: 255, column: 0, row: 255 });
    assert.deepEqual(placeOfCell({ i: -1, j: -1 }), { x: 255, y: 256, column: 255, row: 0 });
  });

  it('inverts i = 256 x + px - 65536 and j = 65535 - (256 y + py) everywhere', () => {
    for (const cell of [
      { i: -65536, j: 65535 },
      { i: 65535, j: -65536 },
      { i: 1234, j: -4321 },
      { i: 255, j: 256 },
    ]) {
      const place = placeOfCell(cell);
      assert.ok(place);
      assert.equal(256 * place.x + place.column - 65536, cell.i);
      assert.equal(65535 - (256 * place.y + place.row), cell.j);
    }
  });

  it('has no tiles outside the square', () => {
    for (const [i, j] of [
      [65536, 0],
      [-65537, 0],
      [0, 65536],
      [0, -65537],
    ] as const) {
      assert.equal(placeOfCell({ i, j }), null);
    }
  });
});
