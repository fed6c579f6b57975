/** One request with a deadline; its failures are two kinds of error. */

const kDeadlineMs = 10_000;
const kUnauthorized = 401;
/** Status codes for which a retry may help: timeout, rate limit, overload. */
const kPassing = [408, 429, 503];

/** The server was not reachable, or did not answer in time. */
export class Unreachable extends Error {
  override name = 'Unreachable';
}

/** The server answered with an error. */
export class Refused extends Error {
  override name = 'Refused';

  constructor(
    readonly status: number,
    message: string,
  ) {
    super(message);
  }
}

/** Whether the server requires a token. Only sign_in.ts handles this error. */
export function isUnauthorized(error: unknown): boolean {
  return error instanceof Refused && error.status === kUnauthorized;
}

/** Whether a retry may help: there was no answer, or a status of kTransient. */
export function isPassing(error: unknown): boolean {
  return error instanceof Unreachable || (error instanceof Refused && kPassing.includes(error.status));
}

let unauthorized: () => void = () => {};

/** @param listener called when the server answers that the request is not authenticated */
export function onUnauthorized(listener: () => void): void {
  unauthorized = listener;
}

/**
 * Gets a resource of this server.
 *
 * @param path relative to the page, so that the viewer works below any prefix
 * @param deadlineMs until the whole answer is received; for large answers
 * @throws Unreachable, Refused, or the signal's reason when the caller gave up
 */
export function get(path: string, signal: AbortSignal, deadlineMs = kDeadlineMs): Promise<Response> {
  return request(path, {}, signal, deadlineMs);
}

/**
 * Changes something on the server; in all else equal to get().
 *
 * @param type media type of the body; null: the browser derives it from the body
 * @param deadlineMs for requests that take the server longer, or that have a large body
 */
export function send(
  method: 'POST' | 'DELETE',
  path: string,
  body: BodyInit | null,
  type: string | null,
  signal: AbortSignal,
  deadlineMs = kDeadlineMs,
): Promise<Response> {
  const headers: HeadersInit = type === null ? {} : { 'Content-Type': type };
  return request(path, { method, body, headers }, signal, deadlineMs);
}

export function sendJson(
  method: 'POST' | 'DELETE',
  path: string,
  value: unknown,
  signal: AbortSignal,
): Promise<Response> {
  return send(method, path, JSON.stringify(value), 'application/json', signal);
}

/** Like get(), for JSON; a truncated body counts as unreachable. */
export async function getJson(path: string, signal: AbortSignal, deadlineMs?: number): Promise<unknown> {
  return parseJson(await get(path, signal, deadlineMs), path, signal);
}

export async function parseJson(response: Response, path: string, signal: AbortSignal): Promise<unknown> {
  const body = await readBody(response, signal, (answer) => answer.text());
  try {
    return JSON.parse(body);
  } catch {
    throw new Refused(response.status, `the answer to ${path} is not JSON`);
  }
}

export async function readBody<T>(
  response: Response,
  signal: AbortSignal,
  read: (response: Response) => Promise<T>,
): Promise<T> {
  try {
    return await read(response);
  } catch (error) {
    signal.throwIfAborted();
    throw new Unreachable('the answer broke off', { cause: error });
  }
}

async function request(path: string, init: RequestInit, signal: AbortSignal, deadlineMs: number): Promise<Response> {
  let response: Response;
  try {
    const deadline = AbortSignal.timeout(deadlineMs);
    const either = AbortSignal.any([signal, deadline]);
    response = await fetch(new URL(path, document.baseURI), { ...init, signal: either });
  } catch (error) {
    signal.throwIfAborted();
    throw new Unreachable('the server does not answer', { cause: error });
  }
  if (response.status === kUnauthorized) unauthorized();
  if (!response.ok) throw new Refused(response.status, await reason(response));
  return response;
}

/** Returns the message of an application/problem+json body, or the bare status. */
async function reason(response: Response): Promise<string> {
  const bare = `status ${response.status}`;
  try {
    const problem: unknown = await response.json();
    if (typeof problem !== 'object' || problem === null) return bare;
    const { title, detail } = problem as Record<string, unknown>;
    const said = [title, detail].filter((part) => typeof part === 'string' && part !== '');
    return said.length > 0 ? said.join(': ') : bare;
  } catch {
    return bare;
  }
}
