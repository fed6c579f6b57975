/** The path from one place to another, which the server plans on its maps. */
import { sessionPath } from './api';
import { decodePoint, fields, list, MalformedAnswer, number } from './decode';
import { parseJson, send } from './http';
import type { Point } from './types';

/** The server queues searches: one may wait for others. */
export const kSearchDeadlineMs = 120_000;

/** A place, or the name of a robot, which stands for the place of its newest scan. */
export type Start = Point | { robot: string };

export interface PlanRequest {
  from: Start;
  to: Point;
  allowUnknown: boolean;
  /** Metres. */
  bodyRadius: number;
  /** Extra cost of a metre in danger cells. */
  dangerCost: number;
}

export interface PlannedPath {
  points: Point[];
  /** Metres. */
  length: number;
  /** Metres, those in danger cells weighted. */
  cost: number;
  /** Revision of the maps. */
  revision: number;
}

/** @throws Refused with the server's message when there is no path */
export async function requestPlan(
  session: string,
  weave: string | null,
  request: PlanRequest,
  signal: AbortSignal,
): Promise<PlannedPath> {
  const { from, to, allowUnknown, bodyRadius, dangerCost } = request;
  const body = { from, to, allow_unknown: allowUnknown, body_radius: bodyRadius, danger_cost: dangerCost };
  return decodePath(await postSearch(session, 'plan', weave, body, signal));
}

/** Requests a path of either kind. */
export async function postSearch(
  session: string,
  what: 'plan' | 'coverage',
  weave: string | null,
  body: unknown,
  signal: AbortSignal,
): Promise<unknown> {
  const query = weave === null ? '' : `?${new URLSearchParams({ weave })}`;
  const path = `${sessionPath(session)}/${what}${query}`;
  const json = JSON.stringify(body);
  return parseJson(await send('POST', path, json, 'application/json', signal, kSearchDeadlineMs), path, signal);
}

function decodePath(json: unknown): PlannedPath {
  const feature = fields(json, 'path');
  const properties = fields(feature['properties'], 'properties');
  return {
    points: decodeLine(feature['geometry']),
    length: number(properties['length'], 'length'),
    cost: number(properties['cost'], 'cost'),
    revision: number(feature['revision'], 'revision'),
  };
}

export function decodeLine(json: unknown): Point[] {
  const points = list(fields(json, 'geometry')['coordinates'], 'geometry.coordinates').map(decodePoint);
  if (points.length < 2) throw new MalformedAnswer('a path has fewer than two points');
  return points;
}
