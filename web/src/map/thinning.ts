/** Keeps symbols apart when many things lie in few pixels. */
import type { Point } from '../api/types';

/** What can be left out when something of more weight is next to it. */
export interface Weighted {
  id: number;
  at: Point;
  weight: number;
}

/**
 * Chooses one thing in each square of the map: the one of most weight, of equal ones that of the lowest id.
 *
 * @param side of the squares, metres
 * @return ids
 */
export function thin(things: Iterable<Weighted>, side: number): Set<number> {
  const best = new Map<string, Weighted>();
  for (const thing of things) {
    const square = `${Math.floor(thing.at[0] / side)} ${Math.floor(thing.at[1] / side)}`;
    const known = best.get(square);
    if (!known || isHeavier(thing, known)) best.set(square, thing);
  }
  return new Set([...best.values()].map(({ id }) => id));
}

function isHeavier(one: Weighted, other: Weighted): boolean {
  return one.weight > other.weight || (one.weight === other.weight && one.id < other.id);
}
