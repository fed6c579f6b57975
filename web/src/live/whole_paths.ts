/** Keeps a session's trails complete: appends the points of events, and fetches missing ones. */
import { MalformedAnswer } from '../api/decode';
import { isPassing } from '../api/http';
import type { LiveEvent } from '../api/live';
import { pagesOf } from '../api/path_pages';
import type { Trajectory } from '../api/types';
import { rest } from '../poll';
import type { Trails } from './trails';

/** The trails of an event; robots that are not in it did not move. */
export type TrailEvent = Pick<LiveEvent, 'revision'> & {
  robots: Pick<LiveEvent['robots'][number], 'name' | 'trail' | 'trailFrom'>[];
};

export interface PathSource {
  /** Fetches the first positions after a revision. */
  fetchAfter(revision: number, signal: AbortSignal): Promise<Trajectory>;
  /** The trails have grown. */
  filled(): void;
}

export class WholePaths {
  /** Every position up to this revision is known, with the number of positions for each robot. */
  private known = 0;
  private readonly counts = new Map<string, number>();
  /** The newest event that did not connect; null: none is missing. */
  private missing: TrailEvent | null = null;
  private isFilling = false;
  /** Number of consecutive failed fetches. */
  private failures = 0;

  /**
   * @param signal aborts when these trails are no longer needed
   * @param pause waits, longer with every consecutive failure
   */
  constructor(
    readonly trails: Trails,
    private readonly source: PathSource,
    private readonly signal: AbortSignal,
    private readonly pause = rest,
  ) {}

  /** Whether the trails have all points before those of the newest event. */
  get isComplete(): boolean {
    const missing = this.missing?.robots ?? [];
    return missing.every(({ name, trailFrom }) => this.trails.get(name).points.length >= trailFrom);
  }

  apply(event: TrailEvent): void {
    if (this.join(event)) {
      // While points are missing, an event that connects does not close the gap; nor does one that a page overtook.
      if (!this.missing && event.revision >= this.known) this.record(event);
      return;
    }
    this.missing = event;
    if (!this.isFilling) void this.fill();
  }

  /** @returns whether the trails contain all points of the event */
  private join({ robots }: TrailEvent): boolean {
    const gap = robots.filter(({ name, trailFrom, trail }) => !this.trails.merge(name, trailFrom, trail));
    return gap.length === 0;
  }

  private record({ revision, robots }: TrailEvent): void {
    this.known = revision;
    for (const { name, trailFrom, trail } of robots) this.counts.set(name, trailFrom + trail.length);
  }

  /** A permanent error is retried when an event finds the gap again, but not at the rate of events. */
  private async fill(): Promise<void> {
    this.isFilling = true;
    for (let again = true; again && this.missing && !this.signal.aborted; ) {
      try {
        await this.fetch();
      } catch (error) {
        again = isPassing(error);
        if (error instanceof MalformedAnswer) this.forget();
        this.failures += 1;
        if (!this.signal.aborted) await this.pause(this.failures, this.signal);
      }
    }
    this.isFilling = false;
  }

  /** Fetches page by page from the known revision; received pages stay when a later page fails. */
  private async fetch(): Promise<void> {
    const { source, signal } = this;
    const wanted = (): number => this.missing?.revision ?? 0;
    for await (const page of pagesOf(this.known, wanted, (revision) => source.fetchAfter(revision, signal))) {
      if (signal.aborted) return;
      this.take(page);
      source.filled();
    }
    this.finish();
  }

  private take({ revision, tracks }: Trajectory): void {
    for (const { robot, points } of tracks) {
      const from = this.counts.get(robot) ?? 0;
      this.trails.merge(robot, from, points);
      this.counts.set(robot, from + points.length);
    }
    this.known = revision;
  }

  private finish(): void {
    if (!this.missing || this.join(this.missing)) {
      this.missing = null;
      this.failures = 0;
      return;
    }
    throw new MalformedAnswer('the paths have fewer positions than a live event reported');
  }

  /** The server has fewer points than before: the known state is invalid. */
  private forget(): void {
    this.known = 0;
    this.counts.clear();
  }
}
