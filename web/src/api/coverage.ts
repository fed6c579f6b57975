/** A coverage path over all free ground of a region, which the server plans on its maps. */
import { decodeAreas, fields, list, MalformedAnswer, number, type Fields } from './decode';
import { decodeLine, postSearch, type Start } from './plan';
import type { Point } from './types';

export interface CoverageRequest {
  start: Start;
  /** Corners of a polygon; null: all free ground of the map. */
  region: Point[] | null;
  /** Metres. */
  bodyRadius: number;
  /** Metres between rows; null: two body radii. */
  spacing: number | null;
}

export interface Coverage {
  points: Point[];
  /** Metres. */
  length: number;
  /** Part of the region's free ground that is covered, from 0 to 1. */
  fraction: number;
  /** Square metres. */
  freeArea: number;
  coveredArea: number;
  unreachableArea: number;
  /** Polygons made of rings. */
  unreachable: Point[][][];
  /** Revision of the maps. */
  revision: number;
}

/** @throws Refused with the server's message when there is no path */
export async function requestCoverage(
  session: string,
  weave: string | null,
  request: CoverageRequest,
  signal: AbortSignal,
): Promise<Coverage> {
  const { start, region, bodyRadius, spacing } = request;
  const body = {
    start,
    body_radius: bodyRadius,
    ...(region !== null && { region }),
    ...(spacing !== null && { spacing }),
  };
  return decodeCoverage(await postSearch(session, 'coverage', weave, body, signal));
}

function decodeCoverage(json: unknown): Coverage {
  const collection = fields(json, 'coverage');
  const features = list(collection['features'], 'features').map((each) => fields(each, 'features[]'));
  const path = featureOf(features, 'path');
  const rest = featureOf(features, 'unreachable');
  const properties = fields(path['properties'], 'properties');
  return {
    points: decodeLine(path['geometry']),
    length: number(properties['length'], 'length'),
    fraction: number(properties['fraction'], 'fraction'),
    freeArea: number(properties['free_area'], 'free_area'),
    coveredArea: number(properties['covered_area'], 'covered_area'),
    unreachableArea: number(properties['unreachable_area'], 'unreachable_area'),
    unreachable: decodeAreas(fields(rest['geometry'], 'geometry')['coordinates']),
    revision: number(collection['revision'], 'revision'),
  };
}

function featureOf(features: Fields[], role: string): Fields {
  const found = features.find((each) => fields(each['properties'], 'properties')['role'] === role);
  if (!found) throw new MalformedAnswer(`there is no feature of the role ${role}`);
  return found;
}
