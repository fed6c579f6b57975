/** Sign-in, for servers that require tokens. */
import { fields, text } from './decode';
import { getJson, parseJson, send, sendJson } from './http';

const kPath = 'api/v1/login';

export interface Login {
  /** Whether the server requires tokens. */
  needed: boolean;
  /** The token with which this page is signed in; null: not signed in. */
  token: { name: string; role: string } | null;
}

export async function fetchLogin(signal: AbortSignal): Promise<Login> {
  return decodeLogin(await getJson(kPath, signal));
}

/** Sends the secret once; afterwards a cookie that scripts cannot read represents it. */
export async function signIn(secret: string, signal: AbortSignal): Promise<Login> {
  return decodeLogin(await parseJson(await sendJson('POST', kPath, { token: secret }, signal), kPath, signal));
}

export async function signOut(signal: AbortSignal): Promise<void> {
  await send('DELETE', kPath, null, null, signal);
}

export function decodeLogin(json: unknown): Login {
  const login = fields(json, 'login');
  const token = login['token'] == null ? null : fields(login['token'], 'token');
  return {
    needed: login['needed'] === true,
    token: token && { name: text(token['name'], 'token.name'), role: text(token['role'], 'token.role') },
  };
}
