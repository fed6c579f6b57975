/** The pose graph of the robots whose poses the server estimates. */
import { kLongMs, sessionPath } from './api';
import { decodePoint, fields, list } from './decode';
import { getJson } from './http';
import type { Point } from './types';

export interface GraphEdge {
  from: Point;
  to: Point;
  /** It connects places that the robot visited again. */
  isLoop: boolean;
  /** False: it disagrees with the others and has no effect. */
  isUsed: boolean;
}

export interface PoseGraph {
  keyframes: Point[];
  edges: GraphEdge[];
}

export async function fetchPoseGraph(name: string, signal: AbortSignal): Promise<PoseGraph> {
  return decodePoseGraph(await getJson(`${sessionPath(name)}/pose_graph.geojson`, signal, kLongMs));
}

export function decodePoseGraph(json: unknown): PoseGraph {
  const graph: PoseGraph = { keyframes: [], edges: [] };
  for (const each of list(fields(json, 'pose graph')['features'], 'features')) {
    const feature = fields(each, 'features[]');
    const { kind, is_used: isUsed } = fields(feature['properties'], 'features[].properties');
    const { coordinates } = fields(feature['geometry'], 'features[].geometry');
    if (kind === 'keyframe') {
      graph.keyframes.push(decodePoint(coordinates));
    } else {
      const [from, to] = list(coordinates, 'coordinates');
      graph.edges.push({
        from: decodePoint(from),
        to: decodePoint(to),
        isLoop: kind === 'loop',
        isUsed: isUsed !== false,
      });
    }
  }
  return graph;
}
