/** One live connection, from its opening to its end. */
import { decodeLiveEvent, encodeLiveRequest, type LiveEvent, type Subscription } from '../api/live';
import { Unreachable } from '../api/http';

/** The session was deleted. */
export const kCodeGone = 4404;

export interface SocketEvents {
  opened(socket: LiveSocket): void;
  event(event: LiveEvent): void;
}

/** How a connection ended: its code (RFC 6455) and the reason text. */
export interface SocketEnd {
  opened: boolean;
  code: number;
  reason: string;
}

export class LiveSocket {
  private constructor(
    private readonly socket: WebSocket,
    private readonly ended: (end: SocketEnd) => void,
  ) {}

  /**
   * Connects and delivers events until the connection ends or the signal aborts.
   *
   * @param path relative to the page
   * @throws the decoder's error for an invalid event, or an error of events.event()
   */
  static follow(path: string, events: SocketEvents, signal: AbortSignal): Promise<SocketEnd> {
    const address = new URL(path, document.baseURI);
    address.protocol = address.protocol === 'https:' ? 'wss:' : 'ws:';
    return new Promise((resolve, reject) => {
      let opened = false;
      const socket = new WebSocket(address);
      socket.binaryType = 'arraybuffer';
      const close = (): void => {
        socket.close();
        resolve({ opened, code: 1006, reason: '' });
      };
      signal.addEventListener('abort', close, { once: true });
      socket.addEventListener('open', () => {
        opened = true;
        events.opened(new LiveSocket(socket, resolve));
      });
      socket.addEventListener('message', ({ data }: MessageEvent<ArrayBuffer>) => {
        if (signal.aborted || socket.readyState !== WebSocket.OPEN) return;
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

  /** Sends the page's subscription to the server. */
  subscribe(subscription: Subscription): void {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(encodeLiveRequest(subscription));
  }

  /** Closes a connection that has become silent, without waiting for the other end. */
  drop(): void {
    this.socket.close();
    this.ended({ opened: true, code: 1006, reason: '' });
  }
}

/** Returns the error to show for an unexpected end. */
export function errorOf({ opened, code, reason }: SocketEnd): Error {
  if (code === 1001 && reason !== '') return new Unreachable(reason);
  if (opened) return new Unreachable('the live connection broke');
  return new Unreachable('there is no live connection');
}
