/** All weaves that the server keeps of a session, each with its settings. */
import { sessionPath } from './api';
import { cellSizeOf, decodeConfig, fields, list, number } from './decode';
import { getJson } from './http';
import type { MapConfig } from './types';
import { decodeWeave, type Weave } from './weaves';

export interface ListedWeave extends Weave {
  config: MapConfig;
  /** Metres. */
  cellSize: number;
  /** Whether a repeated request extends it to the session's current revision. */
  follows: boolean;
  /** Revision of its maps; null while there are none. */
  revision: number | null;
}

/** The most recently used first. */
export async function fetchWeaves(session: string, signal: AbortSignal): Promise<ListedWeave[]> {
  const answer = fields(await getJson(`${sessionPath(session)}/weave`, signal), 'weaves');
  return list(answer['weaves'], 'weaves').map(decodeListed);
}

function decodeListed(json: unknown): ListedWeave {
  const weave = fields(json, 'weaves[]');
  const config = decodeConfig(weave['config']);
  return {
    ...decodeWeave(json),
    config,
    cellSize: cellSizeOf(config),
    follows: weave['follows'] === true,
    revision: weave['revision'] == null ? null : number(weave['revision'], 'weaves[].revision'),
  };
}
