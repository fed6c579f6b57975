/** The way from one place to another, as the server finds it on its maps. */
import { sessionPath } from './api';
import { decodePoint, fields, list, MalformedAnswer, number } from './decode';
import { parseJson, send } from './http';
import type { Point } from './types';

/** Searches take turns on the server: one may wait for others. */
export const kSearchDeadlineMs = 120_000;

/** A place, or where a robot took its newest scan. */
export type Start = Point | { robot: string };

export interface PlanRequest {
  from: Start;
  to: Point;
  allowUnknown: boolean;
  /** Metres. */
  bodyRadius: number;
  /** What a metre in danger costs more than another. */
  dangerCost: number;
}

export interface Way {
  points: Point[];
  /** Metres. */
  length: number;
  /** Metres, those in danger counting more. */
  cost: number;
  /** Of the maps. */
  revision: number;
}

/** @throws Refused with the server's sentence when there is no way */
export async function requestPlan(
  session: string,
  weave: string | null,
  request: PlanRequest,
  signal: AbortSignal,
): Promise<Way> {
  const { from, to, allowUnknown, bodyRadius, dangerCost } = request;
  const body = { from, to, allow_unknown: allowUnknown, body_radius: bodyRadius, danger_cost: dangerCost };
  return decodeWay(await postSearch(session, 'plan', weave, body, signal));
}

/** Asks for a way of either kind. */
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

function decodeWay(json: unknown): Way {
  const feature = fields(json, 'way');
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
  if (points.length < 2) throw new MalformedAnswer('a way has fewer than two points');
  return points;
}
