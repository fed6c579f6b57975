/** Weaves: maps that the server computes again from a session's log. Requests, polls and cancels them. */
import { sessionPath } from './api';
import { fields, MalformedAnswer, number, text } from './decode';
import { getJson, parseJson, Refused, send, sendJson } from './http';

const kStates = ['waiting', 'weaving', 'done', 'failed', 'cancelled'] as const;

export interface Weave {
  id: string;
  state: (typeof kStates)[number];
  /** Number of log entries that were applied so far, and that will be. */
  applied: number;
  until: number;
  /** Revision of the newest change of exclusions that its maps include; 0: none. */
  exclusions: number;
  /** Why it failed or was cancelled; empty: it did not. */
  reason: string;
}

/** Estimated poses of an earlier time: as the server believed then, or as it knows them now. */
export type PastPoses = 'then' | 'now';

/** The settings that differ from the session's; `until`: the last log entry to apply; `poses`: PastPoses. */
export type WeaveRequest = Readonly<Record<string, number | string | boolean>>;

/** Creates a weave. A request with equal settings returns the existing weave with the same id. */
export async function startWeave(session: string, request: WeaveRequest, signal: AbortSignal): Promise<Weave> {
  const path = weavesPath(session);
  return decodeWeave(await parseJson(await sendJson('POST', path, request, signal), path, signal));
}

export async function fetchWeave(session: string, id: string, signal: AbortSignal): Promise<Weave> {
  return decodeWeave(await getJson(weavePath(session, id), signal));
}

/** Deletes the weave, and stops it when it runs. Succeeds also when it does not exist. */
export async function deleteWeave(session: string, id: string, signal: AbortSignal): Promise<void> {
  try {
    await send('DELETE', weavePath(session, id), null, null, signal);
  } catch (error) {
    if (!(error instanceof Refused) || error.status !== 404) throw error;
  }
}

export function decodeWeave(json: unknown): Weave {
  const weave = fields(json, 'weave');
  const state = kStates.find((each) => each === weave['state']);
  if (!state) throw new MalformedAnswer('state of a weave is none of those that are known');
  return {
    id: text(weave['id'], 'id'),
    state,
    applied: number(weave['woven'], 'woven'),
    until: number(fields(weave['until'], 'until')['revision'], 'until.revision'),
    exclusions: weave['exclusions'] == null ? 0 : number(weave['exclusions'], 'exclusions'),
    reason: weave['reason'] == null ? '' : text(weave['reason'], 'reason'),
  };
}

function weavesPath(session: string): string {
  return `${sessionPath(session)}/weave`;
}

function weavePath(session: string, id: string): string {
  return `${weavesPath(session)}/${encodeURIComponent(id)}`;
}
