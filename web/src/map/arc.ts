/** Curves for edges that would cover others if they were straight. */
import type { Point } from '../api/types';

const kPieces = 12;
/** Height of an arc, as a share of the distance of its ends. */
const kHeight = 0.15;

/** Returns an arc from one point to the other, to the left of the straight line. */
export function arcOf(from: Point, to: Point): Point[] {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  // A parabola reaches half the height of its control point.
  const control: Point = [from[0] + dx / 2 - 2 * kHeight * dy, from[1] + dy / 2 + 2 * kHeight * dx];
  return Array.from({ length: kPieces + 1 }, (_, piece): Point => {
    const t = piece / kPieces;
    const at = (axis: 0 | 1): number => (1 - t) ** 2 * from[axis] + 2 * t * (1 - t) * control[axis] + t ** 2 * to[axis];
    return [at(0), at(1)];
  });
}
