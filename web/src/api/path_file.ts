/** Collects a session's trajectories, page by page, in one file. */
import { fetchSession } from './api';
import { fields, list, MalformedAnswer, number, text } from './decode';
import { rest } from '../poll';
import { fetchFile, trajectoryPath } from './export';
import { isPassing } from './http';
import { pagesOf } from './path_pages';

const kGeoJson = 'application/geo+json';
const kRetries = 8;

/** One robot's part of a page. */
interface PathPart {
  robot: string;
  points: number;
  /** The coordinates as text, separated by commas: as values they would need many times the memory. */
  coordinates: string;
}

export interface PathPage {
  frame: string;
  units: string;
  revision: number;
  /** The newest revision at which the poses of earlier scans were corrected; 0: none were. */
  posesCorrected: number;
  parts: PathPart[];
}

/** Takes pages in order; the result has the same members as one answer of the server. */
export class PathFile {
  private newest: PathPage | null = null;
  private readonly paths = new Map<string, PathPart[]>();

  /** @throws MalformedAnswer if poses were corrected since the pages before */
  add(page: PathPage): void {
    if (this.newest !== null && this.newest.posesCorrected !== page.posesCorrected) {
      throw new MalformedAnswer('poses were corrected meanwhile: save the file again');
    }
    this.newest = page;
    for (const part of page.parts) {
      const parts = this.paths.get(part.robot) ?? [];
      this.paths.set(part.robot, parts);
      parts.push(part);
    }
  }

  blob(): Blob {
    const none = { frame: 'map', units: 'm', revision: 0, posesCorrected: 0 };
    const { frame, units, revision, posesCorrected } = this.newest ?? none;
    const head = { type: 'FeatureCollection', frame_id: frame, units, revision, poses_corrected: posesCorrected };
    const features = [...this.paths].flatMap(([robot, parts], index) => [
      index > 0 ? ',' : '',
      ...featureOf(robot, parts),
    ]);
    return new Blob([opened(head), ',"features":[', ...features, ']}'], { type: kGeoJson });
  }
}

/**
 * Downloads all trajectories that the session has at the time of the call.
 *
 * @param progress called with the number of bytes received
 * @param pause waits, longer with every consecutive failure
 * @throws Refused with the server's message
 */
export async function fetchPathFile(
  session: string,
  signal: AbortSignal,
  progress: (bytes: number) => void,
  pause = rest,
): Promise<Blob> {
  const { id, revision: wanted } = await fetchSession(session, signal);
  const file = new PathFile();
  let before = 0;
  const fetchAfter = async (revision: number): Promise<PathPage> => {
    const path = trajectoryPath(session, revision);
    const page = await withRetries(() => fetchFile(path, signal, (bytes) => progress(before + bytes)), signal, pause);
    before += page.size;
    return decodePathPage(await page.text());
  };
  for await (const page of pagesOf(0, () => wanted, fetchAfter)) file.add(page);
  if ((await fetchSession(session, signal)).id !== id) throw new MalformedAnswer('the session was replaced meanwhile');
  return file.blob();
}

/** The server may limit large answers while it serves others: transient errors are retried for about half a minute. */
async function withRetries<T>(task: () => Promise<T>, signal: AbortSignal, pause: typeof rest): Promise<T> {
  for (let failures = 1; ; ++failures) {
    try {
      return await task();
    } catch (error) {
      signal.throwIfAborted();
      if (failures > kRetries || !isPassing(error)) throw error;
      await pause(failures, signal);
    }
  }
}

export function decodePathPage(body: string): PathPage {
  const collection = fields(parse(body), 'trajectory');
  return {
    frame: text(collection['frame_id'], 'frame_id'),
    units: text(collection['units'], 'units'),
    revision: number(collection['revision'], 'revision'),
    posesCorrected: number(collection['poses_corrected'], 'poses_corrected'),
    parts: list(collection['features'], 'features').map(decodePart),
  };
}

function decodePart(json: unknown): PathPart {
  const feature = fields(json, 'features[]');
  const properties = fields(feature['properties'], 'features[].properties');
  const geometry = fields(feature['geometry'], 'features[].geometry');
  const coordinates = list(geometry['coordinates'], 'features[].geometry.coordinates');
  return {
    robot: text(properties['robot'], 'features[].properties.robot'),
    points: coordinates.length,
    coordinates: JSON.stringify(coordinates).slice(1, -1),
  };
}

function parse(body: string): unknown {
  try {
    return JSON.parse(body);
  } catch {
    throw new MalformedAnswer('trajectory is not JSON');
  }
}

/** A line needs two points. */
function featureOf(robot: string, parts: PathPart[]): string[] {
  const points = parts.reduce((sum, part) => sum + part.points, 0);
  const feature = { type: 'Feature', id: robot, properties: { robot, points } };
  const geometry = { type: points < 2 ? 'MultiPoint' : 'LineString' };
  const coordinates = parts
    .filter((part) => part.points > 0)
    .flatMap((part, index) => [index > 0 ? ',' : '', part.coordinates]);
  return [opened(feature), ',"geometry":', opened(geometry), ',"coordinates":[', ...coordinates, ']}}'];
}

/** Returns the text of an object without its closing brace, so that members can be appended. */
function opened(value: object): string {
  return JSON.stringify(value).slice(0, -1);
}
