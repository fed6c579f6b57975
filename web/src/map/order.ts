/** The stacking order of the overlays. */
export const kOrder = {
  cells: 0,
  secondCells: 1,
  difference: 2,
  labels: 3,
  grid: 4,
  trails: 5,
  frontiers: 6,
  paths: 7,
  points: 8,
  landmarks: 9,
  robots: 10,
  marks: 11,
} as const;
