/** Durations of the map's animations. */

/** @returns the duration, or 0 if the system is set to reduced motion */
export function motionMs(durationMs: number): number {
  return matchMedia('(prefers-reduced-motion: reduce)').matches ? 0 : durationMs;
}
