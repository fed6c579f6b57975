/** What robots were told to do, or planned, last. */
import { sessionPath } from './api';
import { decodePoint, fields, list, MalformedAnswer, text } from './decode';
import { getJson } from './http';
import type { Point } from './types';

/** One robot's way, and where it leads. */
export interface RobotGoal {
  robot: string;
  /** Its points, from where the robot was; empty: none is told. */
  way: Point[];
  /** Where to stand; null: the way is none to a goal. */
  goal: Point | null;
  /** What to look at from there. */
  target: Point | null;
}

export async function fetchGoals(name: string, signal: AbortSignal): Promise<RobotGoal[]> {
  return decodeGoals(await getJson(`${sessionPath(name)}/goals.geojson`, signal));
}

export function decodeGoals(json: unknown): RobotGoal[] {
  const byRobot = new Map<string, RobotGoal>();
  for (const each of list(fields(json, 'goals')['features'], 'features')) {
    const feature = fields(each, 'features[]');
    const properties = fields(feature['properties'], 'features[].properties');
    const { coordinates } = fields(feature['geometry'], 'features[].geometry');
    const robot = text(properties['robot'], 'features[].properties.robot');
    const known = byRobot.get(robot) ?? { robot, way: [], goal: null, target: null };
    byRobot.set(robot, known);
    switch (properties['role']) {
      case 'way':
        known.way = list(coordinates, 'coordinates').map(decodePoint);
        break;
      case 'goal':
        known.goal = decodePoint(coordinates);
        known.target = decodePoint(properties['target']);
        break;
      default:
        throw new MalformedAnswer('features[].properties.role is neither way nor goal');
    }
  }
  return [...byRobot.values()];
}
