/** The server's resources that the viewer reads, one function each. */
import { decodeChanges, decodeRobotPort, decodeSession, decodeSessionPage, decodeTrajectory } from './decode';
import { get, getJson, readBody } from './http';
import type { Changes, RobotPort, Session, Sessions, TileChange, Trajectory } from './types';

export const sessionsPath = 'api/v1/sessions';
const kLayer = 'occupancy';
const kPageSize = 100;
const kPagesMax = 20;

/** All sessions, at most kPageSize * kPagesMax of them. */
export async function fetchSessions(signal: AbortSignal): Promise<Sessions> {
  const all: Sessions = { sessions: [], damaged: [] };
  let after: string | null = null;
  for (let page = 0; page < kPagesMax; ++page) {
    const query = new URLSearchParams({ limit: String(kPageSize) });
    if (after !== null) query.set('after', after);
    const answer = decodeSessionPage(await getJson(`${sessionsPath}?${query}`, signal));
    all.sessions.push(...answer.sessions);
    all.damaged.push(...answer.damaged);
    after = answer.next;
    if (after === null) break;
  }
  return all;
}

export async function fetchRobotPort(signal: AbortSignal): Promise<RobotPort> {
  return decodeRobotPort(await getJson('readyz', signal));
}

/** In the text format of Prometheus. */
export async function fetchMetrics(signal: AbortSignal): Promise<string> {
  return readBody(await get('metrics', signal), signal, (answer) => answer.text());
}

export async function fetchSession(name: string, signal: AbortSignal): Promise<Session> {
  return decodeSession(await getJson(sessionPath(name), signal));
}

export async function fetchChanges(name: string, since: number, signal: AbortSignal): Promise<Changes> {
  return decodeChanges(await getJson(`${sessionPath(name)}/changes?layer=${kLayer}&since=${since}`, signal));
}

export async function fetchTrajectory(name: string, since: number, signal: AbortSignal): Promise<Trajectory> {
  return decodeTrajectory(await getJson(`${sessionPath(name)}/trajectory.geojson?since=${since}`, signal));
}

export type SessionKey = Pick<Session, 'name' | 'id'>;

/** 8-bit grey: 0 occupied, 255 free, 128 unknown. */
export async function fetchTileImage(session: SessionKey, tile: TileChange, signal: AbortSignal): Promise<ImageBitmap> {
  const response = await get(tilePath(session, tile, 'png'), signal);
  const blob = await readBody(response, signal, (answer) => answer.blob());
  return createImageBitmap(blob, { colorSpaceConversion: 'none' });
}

/** 256 rows of 256 cells, top row first: percent of occupation 0..100, or 255 where unknown. */
export async function fetchTileCells(session: SessionKey, tile: TileChange, signal: AbortSignal): Promise<Uint8Array> {
  const response = await get(tilePath(session, tile, 'bin'), signal);
  return new Uint8Array(await readBody(response, signal, (answer) => answer.arrayBuffer()));
}

export function sessionPath(name: string): string {
  return `${sessionsPath}/${encodeURIComponent(name)}`;
}

/** The version makes the answer immutable; the id keeps apart sessions that had the same name one after the other. */
function tilePath(session: SessionKey, tile: TileChange, kind: 'png' | 'bin'): string {
  const place = `${tile.z}/${tile.x}/${tile.y}.${kind}`;
  const version = new URLSearchParams({ v: String(tile.revision), id: session.id });
  return `${sessionPath(session.name)}/tiles/${kLayer}/${place}?${version}`;
}
