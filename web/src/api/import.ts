/** A session made from a ROS map. */
import { sessionPath } from './api';
import { decodeSession } from './decode';
import { parseJson, send } from './http';
import type { Session } from './types';

/** A large map takes its time on the way and on the server. */
const kImportDeadlineMs = 600_000;

export interface RosMap {
  /** What map_saver writes beside the image. */
  yaml: File;
  /** PGM or PNG. */
  image: File;
}

/**
 * @param settings of the session, as the server names them; what is left out takes the map's value or the default
 * @throws Refused with the server's sentence when it cannot be made
 */
export async function importMap(
  name: string,
  { yaml, image }: RosMap,
  settings: Record<string, string>,
  signal: AbortSignal,
): Promise<Session> {
  const form = new FormData();
  form.set('yaml', yaml);
  form.set('image', image);
  for (const [setting, value] of Object.entries(settings)) form.set(setting, value);
  const path = `${sessionPath(name)}/import`;
  return decodeSession(await parseJson(await send('POST', path, form, null, signal, kImportDeadlineMs), path, signal));
}
