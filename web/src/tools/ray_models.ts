/** How a laser scan becomes evidence, as the server names it and as people do. */
export const kRayModels = [
  ['inverse_sensor_model', 'Whole beams'],
  ['bresenham', 'Lines to hits'],
  ['traversal', 'All cells crossed'],
] as const;
