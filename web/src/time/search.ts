/** Binary search in increasing lists. */

/** @returns the index of the last value up to this one; -1: all are greater */
export function lastUpTo(values: readonly number[], limit: number): number {
  let [from, to] = [0, values.length];
  while (from < to) {
    const middle = (from + to) >>> 1;
    if ((values[middle] ?? Infinity) <= limit) from = middle + 1;
    else to = middle;
  }
  return from - 1;
}
