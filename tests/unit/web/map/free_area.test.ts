import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { freePadding } from '../../../../web/src/map/free_area';

const kMargin = 30;
/** A control 52 pixels wide, at the top left of a map of 400 x 800. */
const kTools = { left: 12, top: 12, right: 52, bottom: 292 };

describe('the free map area', () => {
  it('has only the margin if no control exceeds it', () => {
    const inMargin = { left: 0, top: 0, right: 28, bottom: 700 };
    assert.deepEqual(freePadding([400, 800], 1, kMargin, [inMargin]), [30, 30, 30, 30]);
  });

  it('is below a control for a wide map and next to it for a tall map', () => {
    const [top, , , left] = freePadding([400, 800], 2, kMargin, [kTools]);
    assert.ok(top > kTools.bottom && left === kMargin);
    const [above, , , shifted] = freePadding([400, 800], 0.3, kMargin, [kTools]);
    assert.ok(above === kMargin && shifted > kTools.right);
  });

  it('avoids controls in all corners', () => {
    const scale = { left: 280, top: 750, right: 388, bottom: 788 };
    const [top, right, bottom, left] = freePadding([400, 800], 2, kMargin, [kTools, scale]);
    assert.ok(top > kTools.bottom || left > kTools.right);
    assert.ok(bottom > 800 - scale.top || right > 400 - scale.left);
  });
});
