/** Movements of the map, for whoever likes to see them. */

/** @returns the duration, or none for people who asked their system for less motion */
export function motionMs(durationMs: number): number {
  return matchMedia('(prefers-reduced-motion: reduce)').matches ? 0 : durationMs;
}
