/** One request, with a deadline, and its failures as two kinds of error. */

const kDeadlineMs = 10_000;
const kUnauthorized = 401;
/** Took too long, asked too often, too much to do. */
const kPassing = [408, 429, 503];

/** The server could not be reached, or did not answer in time. */
export class Unreachable extends Error {
  override name = 'Unreachable';
}

/** The server answered, but not with what was asked for. */
export class Refused extends Error {
  override name = 'Refused';

  constructor(
    readonly status: number,
    message: string,
  ) {
    super(message);
  }
}

/** Whether the server asks for a token: sign_in.ts shows this, no other part of the page. */
export function isUnauthorized(error: unknown): boolean {
  return error instanceof Refused && error.status === kUnauthorized;
}

/** Whether waiting may mend it: there was no answer, or one that says so. */
export function isPassing(error: unknown): boolean {
  return error instanceof Unreachable || (error instanceof Refused && kPassing.includes(error.status));
}

let unauthorized: () => void = () => {};

/** @param told whenever the server answers that it does not know who asks */
export function onUnauthorized(told: () => void): void {
  unauthorized = told;
}

/**
 * Asks for a resource of this server.
 *
 * @param path relative to the page, so that the viewer works below any prefix
 * @param deadlineMs until the whole answer is there; for large ones
 * @throws Unreachable, Refused, or the signal's reason when the caller gave up
 */
export function get(path: string, signal: AbortSignal, deadlineMs = kDeadlineMs): Promise<Response> {
  return ask(path, {}, signal, deadlineMs);
}

/**
 * Changes something on the server; like get in all else.
 *
 * @param type media type of the body; null lets the body speak for itself
 * @param deadlineMs for what takes the server, or the body on its way there, longer
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
  return ask(path, { method, body, headers }, signal, deadlineMs);
}

export function sendJson(
  method: 'POST' | 'DELETE',
  path: string,
  value: unknown,
  signal: AbortSignal,
): Promise<Response> {
  return send(method, path, JSON.stringify(value), 'application/json', signal);
}

/** Like get, for JSON; a body cut off half-way counts as unreachable. */
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

async function ask(path: string, init: RequestInit, signal: AbortSignal, deadlineMs: number): Promise<Response> {
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

/** The sentence of an application/problem+json body, or the bare status. */
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
