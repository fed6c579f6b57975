/** The line that reports connection errors; empty while there are none. */
import { MalformedAnswer } from '../api/decode';
import { isUnauthorized, Refused, Unreachable } from '../api/http';
import { setText } from '../dom';

/** The server announced that it shuts down. */
export class Draining extends Error {
  override name = 'Draining';
}

export type Trouble = { kind: 'offline' | 'error'; text: string };

const kReassureMs = 3_000;

export class Status {
  private readonly troubles = new Map<string, Trouble>();
  private timer = 0;
  private wasOffline = false;
  private isOffline = false;
  private readonly listeners: ((isOffline: boolean) => void)[] = [];

  constructor(private readonly line: HTMLElement) {}

  /**
   * @param source which of the page's requests this is about; each has its own outcome
   * @param error null after success
   */
  settle(source: string, error: unknown): void {
    if (error === null || isUnauthorized(error)) this.troubles.delete(source);
    else this.troubles.set(source, troubleOf(error));
    this.show();
  }

  /** Calls `listener` when the connection to the server is lost (true) and when it is restored (false). */
  listen(listener: (isOffline: boolean) => void): void {
    this.listeners.push(listener);
  }

  /** Forgets the outcome of requests that are no longer made. */
  forget(source: string): void {
    this.troubles.delete(source);
    this.show();
  }

  private show(): void {
    const all = [...this.troubles.values()];
    const worst = all.find(({ kind }) => kind === 'offline') ?? all[0];
    this.notify(worst?.kind === 'offline');
    if (worst) {
      clearTimeout(this.timer);
      this.wasOffline ||= worst.kind === 'offline';
      this.write(worst.kind, worst.text);
    } else if (this.wasOffline) {
      this.wasOffline = false;
      this.write('well', 'Online again.');
      this.timer = window.setTimeout(() => this.write('silent', ''), kReassureMs);
    } else if (this.line.dataset['state'] !== 'well') {
      this.write('silent', '');
    }
  }

  private notify(isOffline: boolean): void {
    if (isOffline === this.isOffline) return;
    this.isOffline = isOffline;
    for (const listener of this.listeners) listener(isOffline);
  }

  private write(state: string, text: string): void {
    this.line.dataset['state'] = state;
    setText(this.line, text);
  }
}

export function troubleOf(error: unknown): Trouble {
  if (error instanceof Unreachable) {
    return {
      kind: 'offline',
      text: 'Offline: the server does not answer. Trying again; the map shows what was last received.',
    };
  }
  if (error instanceof Draining) {
    return {
      kind: 'error',
      text: 'The server is shutting down. It takes no more scans; robots keep theirs until it is back.',
    };
  }
  if (error instanceof Refused) {
    return { kind: 'error', text: `The server reports an error: ${error.message}. Trying again.` };
  }
  if (error instanceof MalformedAnswer) {
    return { kind: 'error', text: `The server's answer cannot be read: ${error.message}. Is it of the same version?` };
  }
  return { kind: 'error', text: `Something in this page failed: ${String(error)}. Reloading may help.` };
}
