/** Creates a session from a ROS map. */
import { sessionPath } from './api';
import { decodeSession } from './decode';
import { parseJson, send } from './http';
import type { Session } from './types';

/** A large map takes long to upload and to read. */
const kImportDeadlineMs = 600_000;

export interface RosMap {
  /** The description that map_saver writes next to the image. */
  yaml: File;
  /** PGM or PNG. */
  image: File;
}

/**
 * @param settings of the session, by the server's names; settings that are left out get the map's value or the default
 * @throws Refused with the server's message when the session cannot be created
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
