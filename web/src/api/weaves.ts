/** Maps made once more from a session's log, on the server: asked for, waited for, given up. */
import { sessionPath } from './api';
import { fields, MalformedAnswer, number, text } from './decode';
import { getJson, parseJson, Refused, send, sendJson } from './http';

const kStates = ['waiting', 'weaving', 'done', 'failed', 'cancelled'] as const;

export interface Weave {
  id: string;
  state: (typeof kStates)[number];
  /** Entries of the log that are in it so far, and that will be. */
  woven: number;
  until: number;
  /** Revision of the newest change of exclusions that its maps follow; 0: there is none. */
  exclusions: number;
  /** Why it failed or was cancelled; empty: it did not. */
  reason: string;
}

/** What is to be other than in the session; `until`: the last entry of the log that is woven. */
export type WeaveRequest = Readonly<Record<string, number | string | boolean>>;

/** Asking for the same again finds the same weave, by the same id. */
export async function startWeave(session: string, request: WeaveRequest, signal: AbortSignal): Promise<Weave> {
  const path = weavesPath(session);
  return decodeWeave(await parseJson(await sendJson('POST', path, request, signal), path, signal));
}

export async function fetchWeave(session: string, id: string, signal: AbortSignal): Promise<Weave> {
  return decodeWeave(await getJson(weavePath(session, id), signal));
}

/** Stops it, too. Also well when there is none any more. */
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
    woven: number(weave['woven'], 'woven'),
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
