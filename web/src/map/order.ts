/** What lies above what on the map. */
export const kOrder = {
  cells: 0,
  cellsBeside: 1,
  difference: 2,
  labels: 3,
  trails: 4,
  frontiers: 5,
  ways: 6,
  points: 7,
  landmarks: 8,
  robots: 9,
  marks: 10,
} as const;
