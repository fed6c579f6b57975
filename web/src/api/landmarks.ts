/** Things that robots saw again and again, as far as this page has heard of them. */
import { sessionPath } from './api';
import { decodePoint, fields, list, number } from './decode';
import { getJson } from './http';
import type { Landmark } from './types';

/** The first answer for a long log takes the server seconds. */
const kDeadlineMs = 30_000;

/** The landmarks of a session; asks for those alone that were seen since it asked last. */
export class Landmarks {
  private readonly known = new Map<number, Landmark>();
  private revision = 0;
  /** Rises when all is forgotten: an answer to an earlier question is of no use then. */
  private generation = 0;

  constructor(private readonly session: string) {}

  /** @returns all of them, by number */
  async fetch(signal: AbortSignal): Promise<Landmark[]> {
    const { generation } = this;
    const path = `${sessionPath(this.session)}/landmarks.geojson?since=${this.revision}`;
    const told = fields(await getJson(path, signal, kDeadlineMs), 'landmarks');
    const seen = list(told['features'], 'features').map(decodeLandmark);
    const revision = number(told['revision'], 'revision');
    if (generation !== this.generation) throw new Error('landmarks were forgotten meanwhile');
    if (told['reset'] === true) this.forget();
    for (const landmark of seen) this.known.set(landmark.id, landmark);
    this.revision = revision;
    return [...this.known.values()];
  }

  /** What is known may be of another session of this name, or of another server's life. */
  forget(): void {
    this.generation += 1;
    this.known.clear();
    this.revision = 0;
  }
}

function decodeLandmark(json: unknown): Landmark {
  const feature = fields(json, 'features[]');
  const properties = fields(feature['properties'], 'features[].properties');
  const geometry = fields(feature['geometry'], 'features[].geometry');
  return {
    id: number(feature['id'], 'id'),
    at: decodePoint(geometry['coordinates']),
    seen: number(properties['seen'], 'seen'),
  };
}
