/** Thins out symbols where many objects share few pixels. */
import type { Point } from '../api/types';

/** An object that may be left out when one of greater weight is close to it. */
export interface Weighted {
  id: number;
  at: Point;
  weight: number;
}

/**
 * Selects one object in each square of the map: the one of greatest weight, among equal ones the lowest id.
 *
 * @param side side length of the squares, metres
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
