/** Splits a trail where its robot cannot have driven: a wrong pose must not draw two long lines across the map. */
import type { Point } from '../api/types';

/** Metres: a shorter step is never a jump. */
const kJumpMin = 2;
/** A jump is this many times longer than the previous steps. */
const kTimesTypical = 10;
/** Number of steps that define the typical length. */
const kRecent = 31;
/** Metres: with a shorter step the robot is stationary. */
const kMoving = 0.01;

export class TrailParts {
  /** Each part is a line without a jump, oldest position first. */
  readonly parts: Point[][] = [];
  /** Lengths of the newest steps of the moving robot, metres. */
  private readonly recent: number[] = [];

  /** Appends positions, oldest first. */
  add(points: Point[]): void {
    for (const point of points) this.addPoint(point);
  }

  private addPoint(point: Point): void {
    const part = this.parts.at(-1);
    const last = part?.at(-1);
    const step = last ? Math.hypot(point[0] - last[0], point[1] - last[1]) : 0;
    if (part && !this.isJump(step)) part.push(point);
    else this.parts.push([point]);
    if (step < kMoving) return;
    this.recent.push(step);
    if (this.recent.length > kRecent) this.recent.shift();
  }

  private isJump(step: number): boolean {
    if (step < kJumpMin || this.recent.length === 0) return false;
    const sorted = [...this.recent].sort((a, b) => a - b);
    return step > kTimesTypical * (sorted[sorted.length >> 1] ?? 0);
  }
}
