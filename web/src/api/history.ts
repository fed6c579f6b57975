/** The trajectories of a session with their times. */
import { kLongMs, sessionPath } from './api';
import { decodePoint, fields, list, MalformedAnswer, number, text } from './decode';
import { getJson } from './http';
import type { Track } from './types';

/** The other data of each scan, one for each point of the track, oldest first. */
export interface TimedTrack extends Track {
  /** The session's revision with this scan. */
  revisions: number[];
  /** When it was taken, seconds of the robot's clock. */
  stamps: number[];
  /** The robot's heading, radians. */
  yaws: number[];
}

export interface TimedTrajectory {
  /** The data are complete up to this revision. */
  revision: number;
  tracks: TimedTrack[];
}

/** Fetches the first scans after a revision. */
export async function fetchHistory(name: string, since: number, signal: AbortSignal): Promise<TimedTrajectory> {
  const query = new URLSearchParams({ times: 'true', since: String(since) });
  return decodeHistory(await getJson(`${sessionPath(name)}/trajectory.geojson?${query}`, signal, kLongMs));
}

export function decodeHistory(json: unknown): TimedTrajectory {
  const collection = fields(json, 'trajectory');
  return {
    revision: number(collection['revision'], 'revision'),
    tracks: list(collection['features'], 'features').map(decodeTrack),
  };
}

function decodeTrack(json: unknown): TimedTrack {
  const feature = fields(json, 'features[]');
  const properties = fields(feature['properties'], 'features[].properties');
  const geometry = feature['geometry'] == null ? {} : fields(feature['geometry'], 'features[].geometry');
  const points = list(geometry['coordinates'] ?? [], 'features[].geometry.coordinates').map(decodePoint);
  const aligned = (name: string): number[] => {
    const values = list(properties[name], `features[].properties.${name}`);
    if (values.length !== points.length) throw new MalformedAnswer(`${name} are not as many as coordinates`);
    return values.map((value) => number(value, `${name}[]`));
  };
  return {
    robot: text(properties['robot'], 'features[].properties.robot'),
    points,
    revisions: aligned('revisions'),
    stamps: aligned('stamps'),
    yaws: aligned('yaws'),
  };
}
