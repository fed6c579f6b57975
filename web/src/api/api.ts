/** The server's resources that the viewer reads, one function each. */
import { decodeChanges, decodeRobotPort, decodeSession, decodeSessionPage, decodeTrajectory } from './decode';
import { get, getJson, readBody } from './http';
import type { LayerName } from '../layers/layers';
import type { Changes, RobotPort, Session, Sessions, TileChange, Trajectory } from './types';

export const sessionsPath = 'api/v1/sessions';
const kPageSize = 100;
const kPagesMax = 20;
/** Timeout of answers that are as long as the session. */
export const kLongMs = 120_000;

/** Returns all sessions, at most kPageSize * kPagesMax of them. */
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

/** Returns the metrics in the text format of Prometheus. */
export async function fetchMetrics(signal: AbortSignal): Promise<string> {
  return readBody(await get('metrics', signal), signal, (answer) => answer.text());
}

export async function fetchSession(name: string, signal: AbortSignal): Promise<Session> {
  return decodeSession(await getJson(sessionPath(name), signal));
}

export interface ChangesQuery {
  layer: LayerName;
  since: number;
  /** Fetches the tiles that changed. `weave`: the weave whose maps are meant; null: the session's own maps. */
  weave: string | null;
}

export async function fetchChanges(
  name: string,
  { layer, since, weave }: ChangesQuery,
  signal: AbortSignal,
): Promise<Changes> {
  const query = new URLSearchParams({ layer, since: String(since), ...(weave !== null && { weave }) });
  return decodeChanges(await getJson(`${sessionPath(name)}/changes?${query}`, signal));
}

export async function fetchTrajectory(name: string, since: number, signal: AbortSignal): Promise<Trajectory> {
  const path = `${sessionPath(name)}/trajectory.geojson?since=${since}`;
  return decodeTrajectory(await getJson(path, signal, kLongMs));
}

export type SessionKey = Pick<Session, 'name' | 'id'>;

/** Maps that have tiles: a layer of a session, or of a weave of it. */
export interface TileSource {
  session: SessionKey;
  layer: LayerName;
  weave: string | null;
}

/** The colours that server/tiles gives the layer's codes; layers/palette.ts has their meaning. */
export async function fetchTileImage(source: TileSource, tile: TileChange, signal: AbortSignal): Promise<ImageBitmap> {
  const response = await get(tilePath(source, tile, 'png'), signal);
  const blob = await readBody(response, signal, (answer) => answer.blob());
  return createImageBitmap(blob, { colorSpaceConversion: 'none' });
}

/** 256 rows of 256 cells, top row first: the layer's codes; layers/cell_value.ts has their meaning. */
export async function fetchTileCells(source: TileSource, tile: TileChange, signal: AbortSignal): Promise<Uint8Array> {
  const response = await get(tilePath(source, tile, 'bin'), signal);
  return new Uint8Array(await readBody(response, signal, (answer) => answer.arrayBuffer()));
}

/** Path of the session's WebSocket. */
export function livePath(name: string): string {
  return `${sessionPath(name)}/live`;
}

export function sessionPath(name: string): string {
  return `${sessionsPath}/${encodeURIComponent(name)}`;
}

/** The version makes the answer immutable; the id distinguishes sessions that had the same name at different times. */
function tilePath({ session, layer, weave }: TileSource, tile: TileChange, kind: 'png' | 'bin'): string {
  const place = `${tile.z}/${tile.x}/${tile.y}.${kind}`;
  const version = new URLSearchParams({ v: String(tile.revision), id: session.id, ...(weave !== null && { weave }) });
  return `${sessionPath(session.name)}/tiles/${layer}/${place}?${version}`;
}
