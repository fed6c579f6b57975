/** Everything the server has to tell about one session, as it happens. */
import { fetchChanges, fetchSession, fetchTrajectory, livePath } from '../api/api';
import { MalformedAnswer } from '../api/decode';
import { Refused } from '../api/http';
import type { LiveEvent, Wishes } from '../api/live';
import type { Session, TileChange } from '../api/types';
import type { LayerName } from '../layers/layers';
import { poll, untilDone, type Pace } from '../poll';
import { errorOf, kCodeGone, LiveSocket } from './socket';
import { Trails } from './trails';
import { WholePaths, type PathSource } from './whole_paths';

/** How soon a connection that ended is tried again; poll() waits longer with every failure in a row. */
const kPace: Pace = { visibleMs: 500, hiddenMs: 5_000 };

/** A connection may be behind what is known of the session for so long: events are due every 50 ms. */
const kSilenceMs = 5_000;

/** What is told as long as nobody has asked for anything. */
const kUnasked: Wishes = { points: true, landmarks: false };

/** The session is another than the one that was asked about. */
class Replaced extends Error {}

export interface FeedEvents {
  /** The session is there, or was made anew under the same name: forget what was shown before. */
  started(session: Session, trails: Trails): void;
  /** There is a live connection: the first, or another after one that ended. */
  opened(): void;
  event(event: LiveEvent): void;
  tiles(layer: LayerName, tiles: TileChange[]): void;
  /** The trails hold more than before. */
  trails(): void;
  /** No such session, or no longer. */
  gone(): void;
  settled(error: unknown): void;
}

/** Follows a session until the signal aborts; afterwards no event comes any more. */
export class Feed {
  private socket: LiveSocket | null = null;
  private id: string | null = null;
  private paths: WholePaths | null = null;
  /** Aborts when the session is another, or gone. */
  private leaving = new AbortController();
  /** Since when the connection has not told what the server is known to have. */
  private behindSince: number | null = null;
  private revision = 0;
  private wishes = kUnasked;
  /** How often in a row events were of another session. */
  private replaced = 0;

  constructor(
    private readonly name: string,
    private readonly events: FeedEvents,
    private readonly signal: AbortSignal,
  ) {}

  run(): void {
    void poll(
      (signal) => this.connect(signal),
      kPace,
      this.signal,
      (error) => error && this.events.settled(error),
    );
  }

  /** What is to be told from now on. */
  ask({ points, landmarks }: Wishes): void {
    this.wishes = { points, landmarks };
    this.socket?.ask(this.wishes);
  }

  /**
   * The session is known to be so far. A connection that does not tell of it has died without a word, as behind a router
   * that forgot it: another is made.
   */
  expect(revision: number): void {
    if (revision <= this.revision) this.behindSince = null;
    else this.behindSince ??= performance.now();
    if (this.behindSince === null || performance.now() - this.behindSince < kSilenceMs) return;
    this.behindSince = null;
    this.socket?.drop();
  }

  /** One connection, from start to end. */
  private async connect(signal: AbortSignal): Promise<void> {
    try {
      const session = await fetchSession(this.name, signal);
      if (session.id !== this.id) this.start(session);
    } catch (error) {
      if (!(error instanceof Refused) || error.status !== 404) throw error;
      this.leave();
      return this.events.settled(null);
    }
    try {
      const end = await LiveSocket.follow(
        livePath(this.name),
        { opened: (socket) => this.opened(socket), event: (event) => this.hear(event) },
        signal,
      );
      if (signal.aborted) return;
      if (end.code === kCodeGone) return this.leave();
      if (!end.opened) throw errorOf(end);
      this.events.settled(errorOf(end));
    } catch (error) {
      if (!(error instanceof Replaced)) throw error;
      this.id = null;
      // Once is a session made anew; again and again, the server contradicts itself.
      if (this.replaced++ > 0) throw new MalformedAnswer('a live event of another session');
    } finally {
      this.socket = null;
    }
  }

  private opened(socket: LiveSocket): void {
    this.socket = socket;
    const { points, landmarks } = this.wishes;
    if (points !== kUnasked.points || landmarks !== kUnasked.landmarks) socket.ask(this.wishes);
    this.events.opened();
  }

  private start(session: Session): void {
    this.id = session.id;
    this.revision = 0;
    this.paths = this.followPaths();
    this.events.started(session, this.paths.trails);
  }

  /** Those of the session before are wanted no more. */
  private followPaths(): WholePaths {
    this.leaving.abort();
    this.leaving = new AbortController();
    const source: PathSource = {
      fetchAfter: (revision, signal) => fetchTrajectory(this.name, revision, signal),
      filled: () => this.events.trails(),
    };
    return new WholePaths(new Trails(), source, AbortSignal.any([this.signal, this.leaving.signal]));
  }

  private leave(): void {
    this.id = null;
    this.leaving.abort();
    this.events.gone();
  }

  private hear(event: LiveEvent): void {
    if (event.id !== this.id) throw new Replaced();
    this.replaced = 0;
    this.paths?.hear(event);
    for (const { layer, everything, tiles } of event.tiles) {
      if (everything) void this.fetchTiles(layer, this.revision);
      else if (tiles.length > 0) this.events.tiles(layer, tiles);
    }
    this.revision = event.revision;
    this.behindSince = null;
    this.events.event(event);
    this.events.settled(null);
  }

  private async fetchTiles(layer: LayerName, since: number): Promise<void> {
    const id = this.id;
    await untilDone(async (signal) => {
      if (id !== this.id) return;
      const { tiles } = await fetchChanges(this.name, { layer, since, weave: null }, signal);
      if (id === this.id && !signal.aborted) this.events.tiles(layer, tiles);
    }, this.signal);
  }
}
