/** One live connection, from its opening to its end. */
import { decodeLiveEvent, encodeLiveRequest, type LiveEvent } from '../api/live';
import { Unreachable } from '../api/http';

/** The session was deleted. */
export const kCodeGone = 4404;

export interface SocketEvents {
  opened(socket: LiveSocket): void;
  event(event: LiveEvent): void;
}

/** How a connection ended: its code (RFC 6455) and the sentence that came with it. */
export interface SocketEnd {
  opened: boolean;
  code: number;
  reason: string;
}

export class LiveSocket {
  private constructor(private readonly socket: WebSocket) {}

  /**
   * Connects and tells what comes, until it ends or the signal aborts.
   *
   * @param path relative to the page
   * @throws what an event that cannot be read is, or an error of events.event()
   */
  static follow(path: string, events: SocketEvents, signal: AbortSignal): Promise<SocketEnd> {
    const address = new URL(path, document.baseURI);
    address.protocol = address.protocol === 'https:' ? 'wss:' : 'ws:';
    return new Promise((resolve, reject) => {
      const socket = new WebSocket(address);
      socket.binaryType = 'arraybuffer';
      let opened = false;
      const close = (): void => socket.close();
      signal.addEventListener('abort', close, { once: true });
      socket.addEventListener('open', () => {
        opened = true;
        events.opened(new LiveSocket(socket));
      });
      socket.addEventListener('message', ({ data }: MessageEvent<ArrayBuffer>) => {
        if (signal.aborted) return;
        try {
          events.event(decodeLiveEvent(data));
        } catch (error) {
          close();
          reject(error);
        }
      });
      socket.addEventListener('close', ({ code, reason }) => {
        signal.removeEventListener('abort', close);
        resolve({ opened, code, reason });
      });
    });
  }

  /** Tells the server what this page shows. */
  ask(points: boolean): void {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(encodeLiveRequest(points));
  }

  close(): void {
    this.socket.close();
  }
}

/** What to tell people about an end that nobody here wanted. */
export function errorOf({ opened, code, reason }: SocketEnd): Error {
  if (code === 1001 && reason !== '') return new Unreachable(reason);
  if (opened) return new Unreachable('the live connection broke');
  return new Unreachable('there is no live connection');
}
