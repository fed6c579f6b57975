/** The ray models: the server's names and their titles. */
export const kRayModels = [
  ['inverse_sensor_model', 'Inverse sensor model'],
  ['bresenham', 'Bresenham'],
  ['traversal', 'Traversal'],
] as const;
