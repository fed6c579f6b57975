/** How a laser scan becomes evidence, as the server names it and as the field does. */
export const kRayModels = [
  ['inverse_sensor_model', 'Inverse sensor model'],
  ['bresenham', 'Bresenham'],
  ['traversal', 'Traversal'],
] as const;
