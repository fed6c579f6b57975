/** The stacking order of the overlays. */
export const kOrder = {
  cells: 0,
  secondCells: 1,
  difference: 2,
  labels: 3,
  grid: 4,
  trails: 5,
  frontiers: 6,
  poseGraph: 7,
  paths: 8,
  points: 9,
  landmarks: 10,
  robots: 11,
  marks: 12,
} as const;
