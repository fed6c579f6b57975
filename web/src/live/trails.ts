/** The trajectory of each robot, assembled from pieces that may overlap or leave gaps. */
import type { Point } from '../api/types';

export interface Trail {
  points: Point[];
  /** Metres travelled. */
  length: number;
}

export class Trails {
  private readonly byRobot = new Map<string, Trail>();

  get(robot: string): Trail {
    let trail = this.byRobot.get(robot);
    if (!trail) {
      trail = { points: [], length: 0 };
      this.byRobot.set(robot, trail);
    }
    return trail;
  }

  /**
   * @param from number of points of the robot's trail before these
   * @returns whether they connect to the known points; otherwise nothing was added
   */
  merge(robot: string, from: number, points: Point[]): boolean {
    const trail = this.get(robot);
    if (from > trail.points.length) return false;
    for (const point of points.slice(trail.points.length - from)) {
      const last = trail.points.at(-1);
      if (last) trail.length += Math.hypot(point[0] - last[0], point[1] - last[1]);
      trail.points.push(point);
    }
    return true;
  }
}
