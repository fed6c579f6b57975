/** The current goals and paths of the robots. */
import { sessionPath } from './api';
import { decodePoint, fields, list, MalformedAnswer, text } from './decode';
import { getJson } from './http';
import type { Point } from './types';

/** One robot's path and its goal. */
export interface RobotGoal {
  robot: string;
  /** Its points, from the robot's position at planning time; empty: unknown. */
  path: Point[];
  /** Where the robot is to stand; null: the path leads to no goal. */
  goal: Point | null;
  /** The place to observe from there. */
  target: Point | null;
}

export interface Goals {
  ofRobots: RobotGoal[];
  /** The robots for which no reachable frontier is left, by the server's last reply to them. */
  explored: string[];
}

export async function fetchGoals(name: string, signal: AbortSignal): Promise<Goals> {
  return decodeGoals(await getJson(`${sessionPath(name)}/goals.geojson`, signal));
}

export function decodeGoals(json: unknown): Goals {
  const goals = fields(json, 'goals');
  const byRobot = new Map<string, RobotGoal>();
  for (const each of list(goals['features'], 'features')) {
    const feature = fields(each, 'features[]');
    const properties = fields(feature['properties'], 'features[].properties');
    const { coordinates } = fields(feature['geometry'], 'features[].geometry');
    const robot = text(properties['robot'], 'features[].properties.robot');
    const known = byRobot.get(robot) ?? { robot, path: [], goal: null, target: null };
    byRobot.set(robot, known);
    switch (properties['role']) {
      case 'way':
        known.path = list(coordinates, 'coordinates').map(decodePoint);
        break;
      case 'goal':
        known.goal = decodePoint(coordinates);
        known.target = decodePoint(properties['target']);
        break;
      default:
        throw new MalformedAnswer('features[].properties.role is neither way nor goal');
    }
  }
  const explored = list(goals['explored'], 'explored').map((each) => text(each, 'explored[]'));
  return { ofRobots: [...byRobot.values()], explored };
}
