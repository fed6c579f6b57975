/** Creates and deletes sessions. */
import { sessionPath, sessionsPath } from './api';
import { decodeSession } from './decode';
import { parseJson, Refused, send, sendJson } from './http';
import type { Session } from './types';

export const kRayModels = ['inverse_sensor_model', 'bresenham', 'traversal'] as const;
export type RayModel = (typeof kRayModels)[number];

export interface SessionRequest {
  name: string;
  /** Metres. */
  cellSize: number;
  rayModel: RayModel;
}

/** The server first closes the session's log, then records the deletion. */
const kDeleteDeadlineMs = 60_000;

export async function createSession(request: SessionRequest, signal: AbortSignal): Promise<Session> {
  const { name, cellSize, rayModel } = request;
  const body = { name, cell_size: cellSize, ray_model: rayModel };
  const response = await sendJson('POST', sessionsPath, body, signal);
  return decodeSession(await parseJson(response, sessionsPath, signal));
}

/** Succeeds also when the session does not exist. */
export async function deleteSession(name: string, signal: AbortSignal): Promise<void> {
  try {
    await send('DELETE', sessionPath(name), null, null, signal, kDeleteDeadlineMs);
  } catch (error) {
    if (!(error instanceof Refused) || error.status !== 404) throw error;
  }
}
