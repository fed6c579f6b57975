/** Periodic polling: slower while the page is hidden, and with exponential backoff while the server is offline. */

export interface Pace {
  visibleMs: number;
  hiddenMs: number;
}

const kBackoffMaxMs = 5_000;
const kRetryMs = 500;

const retries = new EventTarget();

/** Ends all waits, because a retry may succeed now. */
export function retryNow(): void {
  retries.dispatchEvent(new Event('retry'));
}

/**
 * Runs the task, waits, and repeats until the signal aborts; never runs it concurrently. The wait ends early when the
 * page is shown or the network connects.
 *
 * @param report called after every run: null, or the error
 */
export async function poll(
  task: (signal: AbortSignal) => Promise<void>,
  pace: Pace,
  signal: AbortSignal,
  report: (error: unknown) => void,
): Promise<void> {
  let failures = 0;
  while (!signal.aborted) {
    try {
      await task(signal);
      failures = 0;
      report(null);
    } catch (error) {
      if (signal.aborted) return;
      failures += 1;
      report(error);
    }
    const everyMs = document.hidden ? pace.hiddenMs : pace.visibleMs;
    await pause(backoff(everyMs, failures), signal);
  }
}

/** Runs the task until it succeeds once, or the signal aborts. */
export async function untilDone(task: (signal: AbortSignal) => Promise<void>, signal: AbortSignal): Promise<void> {
  for (let failures = 1; !signal.aborted; ++failures) {
    try {
      return await task(signal);
    } catch {
      // Other parts of the page report connection errors.
      await rest(failures, signal);
    }
  }
}

/** Waits before a retry after `failures` consecutive failures; ends early as the waits of poll() do. */
export function rest(failures: number, signal: AbortSignal): Promise<void> {
  return pause(backoff(kRetryMs, failures), signal);
}

/** Doubles with every consecutive failure, up to a few seconds. */
export function backoff(everyMs: number, failures: number): number {
  if (failures === 0) return everyMs;
  return Math.max(everyMs, Math.min(kBackoffMaxMs, everyMs * 2 ** failures));
}

function pause(durationMs: number, signal: AbortSignal): Promise<void> {
  return new Promise((resolve) => {
    const done = new AbortController();
    const finish = (): void => {
      clearTimeout(timer);
      done.abort();
      resolve();
    };
    const timer = setTimeout(finish, durationMs);
    signal.addEventListener('abort', finish, { signal: done.signal });
    window.addEventListener('online', finish, { signal: done.signal });
    retries.addEventListener('retry', finish, { signal: done.signal });
    document.addEventListener('visibilitychange', () => document.hidden || finish(), { signal: done.signal });
  });
}
