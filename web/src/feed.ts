/** Everything the server has to tell about one session, as it happens. */
import { fetchChanges, fetchSession, fetchTrajectory } from './api/api';
import { Refused } from './api/http';
import type { Session, TileChange, Track } from './api/types';
import { poll, type Pace } from './poll';

const kPace: Pace = { visibleMs: 300, hiddenMs: 5_000 };
/** Robots come and go without a scan, so the session is asked about at least this often. */
const kSessionMaxAgeMs = 2_000;

export interface FeedEvents {
  /** The session is there, or was made anew under the same name: forget what was shown before. */
  started(session: Session): void;
  /** Counters, bounds, robots and their poses. */
  session(session: Session): void;
  tiles(tiles: TileChange[]): void;
  tracks(tracks: Track[]): void;
  /** No such session, or no longer. */
  gone(): void;
  settled(error: unknown): void;
}

/** Follows a session until the signal aborts; afterwards no event comes any more. */
export function followSession(name: string, events: FeedEvents, signal: AbortSignal): void {
  const feed = new Feed(name, events);
  void poll((stop) => feed.round(stop), kPace, signal, (error) => events.settled(error));
}

class Feed {
  private id: string | null = null;
  private revision = 0;
  private pathRevision = 0;
  private sessionAt = -Infinity;

  constructor(
    private readonly name: string,
    private readonly events: FeedEvents,
  ) {}

  async round(signal: AbortSignal): Promise<void> {
    try {
      await this.update(signal);
    } catch (error) {
      if (!(error instanceof Refused) || error.status !== 404) throw error;
      this.id = null;
      this.events.gone();
    }
  }

  private async update(signal: AbortSignal): Promise<void> {
    if (this.id === null) await this.start(await this.fetchSession(signal), signal);
    else await this.advance(signal);
    if (this.pathRevision < this.revision) await this.updateTracks(signal);
  }

  private async start(session: Session, signal: AbortSignal): Promise<void> {
    const changes = await fetchChanges(this.name, 0, signal);
    this.id = session.id;
    this.revision = changes.revision;
    this.pathRevision = 0;
    this.events.started(session);
    this.events.tiles(changes.tiles);
  }

  private async advance(signal: AbortSignal): Promise<void> {
    const changes = await fetchChanges(this.name, this.revision, signal);
    const moved = changes.revision !== this.revision;
    if (!moved && performance.now() - this.sessionAt < kSessionMaxAgeMs) return;
    const session = await this.fetchSession(signal);
    // Deleted and made anew since the last round: what `changes` said is not about what is shown.
    if (session.id !== this.id) return this.start(session, signal);
    this.revision = changes.revision;
    this.events.session(session);
    if (changes.tiles.length > 0) this.events.tiles(changes.tiles);
  }

  private async updateTracks(signal: AbortSignal): Promise<void> {
    const trajectory = await fetchTrajectory(this.name, this.pathRevision, signal);
    this.pathRevision = trajectory.revision;
    if (trajectory.tracks.length > 0) this.events.tracks(trajectory.tracks);
  }

  private async fetchSession(signal: AbortSignal): Promise<Session> {
    const session = await fetchSession(this.name, signal);
    this.sessionAt = performance.now();
    return session;
  }
}
