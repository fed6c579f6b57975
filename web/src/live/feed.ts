/** Receives all live updates of one session. */
import { fetchChanges, fetchSession, fetchTrajectory, livePath } from '../api/api';
import { MalformedAnswer } from '../api/decode';
import { Refused } from '../api/http';
import type { LiveEvent, Subscription } from '../api/live';
import type { Session, TileChange } from '../api/types';
import type { LayerName } from '../layers/layers';
import { poll, untilDone, type Pace } from '../poll';
import { errorOf, kCodeGone, LiveSocket } from './socket';
import { Trails } from './trails';
import { WholePaths, type PathSource } from './whole_paths';

/** First delay before a reconnect; poll() waits longer with every consecutive failure. */
const kPace: Pace = { visibleMs: 500, hiddenMs: 5_000 };

/** How long a connection may lag behind the session's known revision: events are due every 50 ms. */
const kSilenceMs = 5_000;

/** Subscriptions before the first call of subscribe(). */
const kDefaultSubscription: Subscription = { points: true, landmarks: false };

/** The session's id has changed. */
class Replaced extends Error {}

export interface FeedEvents {
  /** The session was found, or was recreated under the same name: discard the previous state. */
  started(session: Session, trails: Trails): void;
  /** A live connection was established: the first, or a reconnect. */
  opened(): void;
  event(event: LiveEvent): void;
  tiles(layer: LayerName, tiles: TileChange[]): void;
  /** The trails have grown. */
  trails(): void;
  /** These trails, of the same session, replace the others: the poses of earlier scans were corrected. */
  corrected(trails: Trails): void;
  /** The session does not exist, or was deleted. */
  gone(): void;
  settled(error: unknown): void;
}

/** Follows a session until the signal aborts; no event is delivered after that. */
export class Feed {
  private socket: LiveSocket | null = null;
  private id: string | null = null;
  private paths: WholePaths | null = null;
  /** The trails that the page shows: those of `paths`, or the earlier ones until those are complete. */
  private shown: Trails | null = null;
  /** LiveEvent.posesCorrected of the newest event; null: none yet. */
  private posesCorrected: number | null = null;
  /** Aborts when the session is replaced or deleted. */
  private leaving = new AbortController();
  /** Since when the connection lags behind the known revision; null: it does not. */
  private behindSince: number | null = null;
  private revision = 0;
  private subscription = kDefaultSubscription;
  /** Number of consecutive connections with events of another session. */
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

  /** Changes the subscription. */
  subscribe({ points, landmarks }: Subscription): void {
    this.subscription = { points, landmarks };
    this.socket?.subscribe(this.subscription);
  }

  /**
   * Reports a revision that the session is known to have. If the connection does not deliver it in time, the connection
   * is dead, for example because a router dropped it: it is replaced.
   */
  expect(revision: number): void {
    if (revision <= this.revision) this.behindSince = null;
    else this.behindSince ??= performance.now();
    if (this.behindSince === null || performance.now() - this.behindSince < kSilenceMs) return;
    this.behindSince = null;
    this.socket?.drop();
  }

  /** Runs one connection, from start to end. */
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
        { opened: (socket) => this.opened(socket), event: (event) => this.receive(event) },
        signal,
      );
      if (signal.aborted) return;
      if (end.code === kCodeGone) return this.leave();
      if (!end.opened) throw errorOf(end);
      this.events.settled(errorOf(end));
    } catch (error) {
      if (!(error instanceof Replaced)) throw error;
      this.id = null;
      // A session may be recreated once; repeated changes of the id mean that the server contradicts itself.
      if (this.replaced++ > 0) throw new MalformedAnswer('a live event of another session');
    } finally {
      this.socket = null;
    }
  }

  private opened(socket: LiveSocket): void {
    this.socket = socket;
    const { points, landmarks } = this.subscription;
    if (points !== kDefaultSubscription.points || landmarks !== kDefaultSubscription.landmarks)
      socket.subscribe(this.subscription);
    this.events.opened();
  }

  private start(session: Session): void {
    this.id = session.id;
    this.revision = 0;
    this.posesCorrected = null;
    this.paths = this.followPaths();
    this.shown = this.paths.trails;
    this.events.started(session, this.shown);
  }

  /** Cancels requests for the previous trails. */
  private followPaths(): WholePaths {
    this.leaving.abort();
    this.leaving = new AbortController();
    const source: PathSource = {
      fetchAfter: (revision, signal) => fetchTrajectory(this.name, revision, signal),
      filled: () => {
        this.replaceTrails();
        this.events.trails();
      },
    };
    return new WholePaths(new Trails(), source, AbortSignal.any([this.signal, this.leaving.signal]));
  }

  private applyTrails(event: LiveEvent): void {
    if (this.posesCorrected !== null && event.posesCorrected !== this.posesCorrected) this.paths = this.followPaths();
    this.posesCorrected = event.posesCorrected;
    this.paths?.apply(event);
    this.replaceTrails();
  }

  /** Shows the corrected trails when they are complete. */
  private replaceTrails(): void {
    if (!this.paths?.isComplete || this.paths.trails === this.shown) return;
    this.shown = this.paths.trails;
    this.events.corrected(this.shown);
  }

  private leave(): void {
    this.id = null;
    this.leaving.abort();
    this.events.gone();
  }

  private receive(event: LiveEvent): void {
    if (event.id !== this.id) throw new Replaced();
    this.replaced = 0;
    this.applyTrails(event);
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
