/** Everything the server has to tell about one session, as it happens. */
import { fetchChanges, fetchSession, fetchTrajectory, livePath } from '../api/api';
import { Refused } from '../api/http';
import type { LiveEvent } from '../api/live';
import type { Session, TileChange } from '../api/types';
import type { LayerName } from '../layers/layers';
import { poll, type Pace } from '../poll';
import { errorOf, kCodeGone, LiveSocket } from './socket';
import { Trails } from './trails';

/** How soon a connection that ended is tried again; poll() waits longer with every failure in a row. */
const kPace: Pace = { visibleMs: 500, hiddenMs: 5_000 };

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
  private trails = new Trails();
  private revision = 0;
  private wantsPoints = true;

  constructor(
    private readonly name: string,
    private readonly events: FeedEvents,
    private readonly signal: AbortSignal,
  ) {}

  run(): void {
    void poll((signal) => this.connect(signal), kPace, this.signal, (error) => error && this.events.settled(error));
  }

  /** Whether the newest scans are to be told. */
  showPoints(wanted: boolean): void {
    this.wantsPoints = wanted;
    this.socket?.ask(wanted);
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
    } finally {
      this.socket = null;
    }
  }

  private opened(socket: LiveSocket): void {
    this.socket = socket;
    if (!this.wantsPoints) socket.ask(false);
    this.events.opened();
  }

  private start(session: Session): void {
    this.id = session.id;
    this.revision = 0;
    this.trails = new Trails();
    this.events.started(session, this.trails);
  }

  private leave(): void {
    this.id = null;
    this.events.gone();
  }

  private hear(event: LiveEvent): void {
    if (event.id !== this.id) throw new Replaced();
    const gap = event.robots.filter(({ name, trail, trailFrom }) => !this.trails.merge(name, trailFrom, trail));
    if (gap.length > 0) void this.orBeginAnew(this.fetchTrails(this.trails));
    for (const { layer, everything, tiles } of event.tiles) {
      if (everything) void this.orBeginAnew(this.fetchTiles(layer, this.revision));
      else if (tiles.length > 0) this.events.tiles(layer, tiles);
    }
    this.revision = event.revision;
    this.events.event(event);
    this.events.settled(null);
  }

  /** What could not be fetched, the first event of another connection tells again. */
  private async orBeginAnew(fetched: Promise<void>): Promise<void> {
    await fetched.catch(() => this.socket?.close());
  }

  private async fetchTrails(trails: Trails): Promise<void> {
    const { tracks } = await fetchTrajectory(this.name, 0, this.signal);
    for (const { robot, points } of tracks) trails.merge(robot, 0, points);
    if (trails === this.trails && !this.signal.aborted) this.events.trails();
  }

  private async fetchTiles(layer: LayerName, since: number): Promise<void> {
    const id = this.id;
    const { tiles } = await fetchChanges(this.name, { layer, since, weave: null }, this.signal);
    if (id === this.id && !this.signal.aborted) this.events.tiles(layer, tiles);
  }
}
