/** Files that the server makes of a session: their addresses, and how to download them. */
import { sessionPath } from './api';
import { get, readBody, Unreachable } from './http';
import type { LayerName } from '../layers/layers';

export type MapFormat = 'png' | 'pgw' | 'pgm' | 'yaml' | 'csv' | 'npy';

export interface MapQuery {
  layer: LayerName;
  /** [min_x, min_y, max_x, max_y], metres; null: the whole map. */
  box: [number, number, number, number] | null;
  /** Null: the session's own maps. */
  weave: string | null;
}

/** The server draws a large map before it sends it, and the link may be slow. */
export const kFileDeadlineMs = 600_000;
/** To the millimetre: smaller than any cell. */
const kDigits = 3;

export function mapFilePath(session: string, format: MapFormat, { layer, box, weave }: MapQuery): string {
  const query = new URLSearchParams({ layer });
  if (box) query.set('bbox', box.map((edge) => edge.toFixed(kDigits)).join(','));
  if (weave !== null) query.set('weave', weave);
  return `${sessionPath(session)}/map.${format}?${query}`;
}

/** @param since only the positions after this revision; 0: all */
export function trajectoryPath(session: string, since = 0): string {
  return `${sessionPath(session)}/trajectory.geojson${since === 0 ? '' : `?since=${since}`}`;
}

export function frontiersPath(session: string, weave: string | null): string {
  return `${sessionPath(session)}/frontiers.geojson${weave === null ? '' : `?${new URLSearchParams({ weave })}`}`;
}

/** Metres of the map. */
export function landmarksPath(session: string): string {
  return `${sessionPath(session)}/landmarks.geojson`;
}

/** The poses of all robots. */
export function posesPath(session: string, file: 'trajectory.tum' | 'pose_graph.g2o'): string {
  return `${sessionPath(session)}/${file}`;
}

/** The points of all scans, fused to one cloud. */
export function pointsPath(session: string, format: 'csv' | 'ply' | 'pcd'): string {
  return `${sessionPath(session)}/points.${format}`;
}

export function logPath(session: string, format: 'clf' | 'mcap' | 'protobuf'): string {
  return `${sessionPath(session)}/log?format=${format}`;
}

/**
 * Downloads the whole file, for files that the server limits to some 100 MB.
 *
 * @param progress called with the number of bytes received
 * @throws Refused with the server's message
 */
export async function fetchFile(path: string, signal: AbortSignal, progress: (bytes: number) => void): Promise<Blob> {
  const response = await get(path, signal, kFileDeadlineMs);
  return readBody(response, signal, async ({ body, headers }) => {
    if (!body) throw new Unreachable('the answer has no body');
    const reader = body.getReader();
    const parts: Uint8Array<ArrayBuffer>[] = [];
    let bytes = 0;
    for (;;) {
      const { done, value } = await reader.read();
      if (done) break;
      parts.push(value as Uint8Array<ArrayBuffer>);
      bytes += value.length;
      progress(bytes);
    }
    return new Blob(parts, { type: headers.get('Content-Type') ?? '' });
  });
}

/** Requests a file of unlimited length without reading it, to find errors. @throws Refused with the server's message */
export async function checkFile(path: string, signal: AbortSignal): Promise<void> {
  const giveUp = new AbortController();
  const response = await get(path, AbortSignal.any([signal, giveUp.signal]));
  await response.body?.cancel();
  giveUp.abort();
}
