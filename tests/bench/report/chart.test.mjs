import assert from 'node:assert/strict';
import { test } from 'node:test';
import { drawCharts } from './chart.mjs';

/** Returns the first and last point of the dashed line, and the circles of the points. */
function drawn(points, expected) {
  const svg = drawCharts([{ title: 't', x: 'x', y: 'y', points, expected }]);
  const guide = /<polyline points="([^"]*)" clip-path="url\(#frame\)"[^>]*stroke-dasharray/.exec(svg)[1];
  const circles = [...svg.matchAll(/<circle cx="([^"]*)" cy="([^"]*)"/g)].map(([, x, y]) => [Number(x), Number(y)]);
  return { svg, guide: guide.split(' ').map((at) => at.split(',').map(Number)), circles };
}

const slope = ([[x0, y0], [x1, y1]]) => (y1 - y0) / (x1 - x0);

test('the dashed line starts at the first point', () => {
  const { guide, circles } = drawn(
    [
      [1, 5],
      [10, 7],
      [100, 60],
    ],
    1,
  );
  assert.deepEqual(guide[0], circles[0]);
});

test('it passes through points that grow as expected', () => {
  const { guide, circles } = drawn(
    [
      [1, 3],
      [10, 300],
      [100, 30000],
    ],
    2,
  );
  assert.ok(Math.abs(slope(guide) - slope([circles[0], circles[2]])) < 0.02);
});

test('it stays straight where it leaves the frame, and is clipped there', () => {
  const { svg, guide } = drawn(
    [
      [1, 3],
      [10, 4],
      [100, 5],
    ],
    2,
  );
  const frame = /<clipPath id="frame"><rect x="[^"]*" y="([^"]*)"/.exec(svg);
  assert.equal(guide.length, 2);
  assert.ok(guide[1][1] < Number(frame[1]));
});

test('the drawing has a note that its axes are logarithmic', () => {
  assert.match(
    drawn(
      [
        [1, 1],
        [2, 2],
      ],
      1,
    ).svg,
    /logarithmic/,
  );
});
