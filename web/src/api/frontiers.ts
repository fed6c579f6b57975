/** The frontiers: borders between explored and unexplored ground. */
import { sessionPath } from './api';
import { decodeAreas, decodePoint, fields, list, number } from './decode';
import { getJson, Refused } from './http';
import type { Frontier } from './types';

/** Null while no robot has a position to start from. */
export async function fetchFrontiers(name: string, signal: AbortSignal): Promise<Frontier[]> {
  try {
    return decodeFrontiers(await getJson(`${sessionPath(name)}/frontiers.geojson`, signal));
  } catch (error) {
    if (error instanceof Refused && error.status === 409) return [];
    throw error;
  }
}

function decodeFrontiers(json: unknown): Frontier[] {
  return list(fields(json, 'frontiers')['features'], 'features').map((each) => {
    const feature = fields(each, 'features[]');
    const properties = fields(feature['properties'], 'features[].properties');
    const geometry = fields(feature['geometry'], 'features[].geometry');
    return {
      areas: decodeAreas(geometry['coordinates']),
      centroid: decodePoint(properties['centroid']),
      area: number(properties['area'], 'area'),
      reachable: properties['reachable'] === true,
      goal: properties['goal'] == null ? null : decodePoint(properties['goal']),
    };
  });
}
