/** Requests that change how the server localizes robots. For operators. */
import { sessionPath } from './api';
import { send, sendJson } from './http';
import type { Point } from './types';

/** Where the next scan of a robot is searched for. */
export interface Whereabouts {
  robot: string;
  /** Metres in the map frame. */
  near: Point;
  /** Metres. */
  radius: number;
}

/** @throws Refused with the server's message when the server does not locate the robot */
export async function relocalize(session: string, whereabouts: Whereabouts, signal: AbortSignal): Promise<void> {
  await sendJson('POST', `${sessionPath(session)}/relocalize`, whereabouts, signal);
}

/**
 * @param isLocalizeOnly whether the map shall not change from now on
 * @throws Refused with the server's message when the session's robots do not permit it
 */
export async function changeMode(session: string, isLocalizeOnly: boolean, signal: AbortSignal): Promise<void> {
  await sendJson('POST', `${sessionPath(session)}/mode`, { localize_only: isLocalizeOnly }, signal);
}

/** Copying the log of a long recording takes a while. */
const kEstimateDeadlineMs = 600_000;

/**
 * Has the poses of a session estimated that its robots sent as poses in the map frame.
 *
 * @throws Refused with the server's message when one of these robots is connected
 */
export async function estimateSession(session: string, signal: AbortSignal): Promise<void> {
  const body = JSON.stringify({ poses: 'odometry' });
  await send('POST', `${sessionPath(session)}/estimate`, body, 'application/json', signal, kEstimateDeadlineMs);
}
