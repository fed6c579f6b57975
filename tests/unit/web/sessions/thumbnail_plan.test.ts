import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { planThumbnail } from '../../../../web/src/sessions/thumbnail_plan';

describe('a thumbnail', () => {
  it('of a small map needs one tile at full resolution', () => {
    const plan = planThumbnail({ minX: 1, minY: 2, maxX: 4, maxY: 3 }, 0.05);
    assert.deepEqual(plan, { width: 60, height: 20, tiles: [{ z: 9, x: 256, y: 255, left: -20, top: -196 }] });
  });

  it('of a map around the origin needs four adjacent tiles', () => {
    const { width, height, tiles } = planThumbnail({ minX: -12.8, minY: -12.8, maxX: 12.8, maxY: 12.8 }, 0.05);
    assert.deepEqual([width, height], [128, 128]);
    assert.deepEqual(tiles, [
      { z: 7, x: 63, y: 63, left: -192, top: -192 },
      { z: 7, x: 64, y: 63, left: 64, top: -192 },
      { z: 7, x: 63, y: 64, left: -192, top: 64 },
      { z: 7, x: 64, y: 64, left: 64, top: 64 },
    ]);
  });

  it('uses the finest zoom at which the map is small', () => {
    const zoomOf = (side: number): number | undefined =>
      planThumbnail({ minX: 0, minY: 0, maxX: side, maxY: 1 }, 0.1).tiles[0]?.z;
    assert.deepEqual([12.8, 12.9, 25.6, 25.7].map(zoomOf), [9, 8, 8, 7]);
  });

  it('of bounds outside the grid stays within the grid', () => {
    const { tiles } = planThumbnail({ minX: -1e9, minY: -1e9, maxX: 1e9, maxY: 1e9 }, 0.05);
    assert.deepEqual(tiles, [{ z: 0, x: 0, y: 0, left: 0, top: 0 }]);
  });

  it('has a size even if the bounds are empty', () => {
    const { width, height, tiles } = planThumbnail({ minX: 0, minY: 0, maxX: 0, maxY: 0 }, 0.05);
    assert.ok(width > 0 && height > 0 && tiles.length > 0, JSON.stringify({ width, height, tiles }));
  });
});
