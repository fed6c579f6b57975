/** The differences between two maps of one session: in numbers, and as a picture. */
import { sessionPath } from './api';
import { fields, MalformedAnswer, number } from './decode';
import { kFileDeadlineMs } from './export';
import { get, parseJson, readBody } from './http';
import type { LayerName } from '../layers/layers';

/** What the two maps, A and B, contain at a place. */
export const kDifferences = [
  'only_a',
  'only_b',
  'both_free',
  'both_occupied',
  'free_occupied',
  'occupied_free',
  'undecided',
] as const;

export type DifferenceName = (typeof kDifferences)[number];

export interface DifferenceQuery {
  layer: LayerName;
  /** The weave that is A; null: the session's own maps. */
  weave: string | null;
  /** The weave that is B. */
  with: string;
}

export interface Difference {
  /** Square metres of each kind. */
  areas: Record<DifferenceName, number>;
  /** Part of the area known to both in which they agree, from 0 to 1; null: no common area. */
  agreement: number | null;
  /** Mean absolute difference of the probability; null for layers that have none. */
  meanDifference: number | null;
}

export interface DifferencePicture {
  png: Blob;
  /** [min_x, min_y, max_x, max_y], metres. */
  extent: [number, number, number, number];
}

export async function fetchDifference(
  session: string,
  query: DifferenceQuery,
  signal: AbortSignal,
): Promise<Difference> {
  const path = pathOf(session, 'difference', query);
  return decodeDifference(await parseJson(await get(path, signal, kFileDeadlineMs), path, signal));
}

export async function fetchDifferencePicture(
  session: string,
  query: DifferenceQuery,
  signal: AbortSignal,
): Promise<DifferencePicture> {
  const response = await get(pathOf(session, 'difference.png', query), signal, kFileDeadlineMs);
  const extent = decodeExtent(response.headers.get('Scanloom-Bounds'));
  return { png: await readBody(response, signal, (answer) => answer.blob()), extent };
}

function pathOf(session: string, file: string, query: DifferenceQuery): string {
  const { layer, weave } = query;
  const parameters = new URLSearchParams({ layer, with: query.with, ...(weave !== null && { weave }) });
  return `${sessionPath(session)}/${file}?${parameters}`;
}

function decodeDifference(json: unknown): Difference {
  const difference = fields(json, 'difference');
  const areas = fields(difference['areas'], 'areas');
  const byName = kDifferences.map((name) => [name, number(areas[name], `areas.${name}`)]);
  return {
    areas: Object.fromEntries(byName) as Difference['areas'],
    agreement: orNull(difference['agreement'], 'agreement'),
    meanDifference: orNull(difference['mean_difference'], 'mean_difference'),
  };
}

function orNull(json: unknown, where: string): number | null {
  return json == null ? null : number(json, where);
}

function decodeExtent(header: string | null): DifferencePicture['extent'] {
  const edges = (header ?? '').split(',').map(Number);
  const [minX = NaN, minY = NaN, maxX = NaN, maxY = NaN] = edges;
  if (edges.length !== 4 || !(minX < maxX && minY < maxY)) {
    throw new MalformedAnswer('the picture does not say where it lies');
  }
  return [minX, minY, maxX, maxY];
}
