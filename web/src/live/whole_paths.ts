/** Keeps a session's trails whole: what events tell joins on, and what they leave out is fetched. */
import { MalformedAnswer } from '../api/decode';
import { isPassing } from '../api/http';
import type { LiveEvent } from '../api/live';
import { pagesOf } from '../api/path_pages';
import type { Trajectory } from '../api/types';
import { rest } from '../poll';
import type { Trails } from './trails';

/** What an event tells of paths: those of robots that are not in it end as they did. */
export type Told = Pick<LiveEvent, 'revision'> & {
  robots: Pick<LiveEvent['robots'][number], 'name' | 'trail' | 'trailFrom'>[];
};

export interface PathSource {
  /** The positions after a revision, or the first of them. */
  fetchAfter(revision: number, signal: AbortSignal): Promise<Trajectory>;
  /** The trails hold more than before. */
  filled(): void;
}

export class WholePaths {
  /** Up to this revision every position is known, and of each robot there are so many. */
  private known = 0;
  private readonly counts = new Map<string, number>();
  /** The newest event that did not join on; null: all did, or were fetched. */
  private missing: Told | null = null;
  private isFilling = false;
  /** How often in a row fetching failed. */
  private failures = 0;

  /**
   * @param signal aborts when these trails are wanted no more
   * @param pause waits, longer with every failure in a row
   */
  constructor(
    readonly trails: Trails,
    private readonly source: PathSource,
    private readonly signal: AbortSignal,
    private readonly pause = rest,
  ) {}

  hear(event: Told): void {
    if (this.join(event)) {
      // While one is missing, others that join on say nothing of what came between; nor do those that a page overtook.
      if (!this.missing && event.revision >= this.known) this.know(event);
      return;
    }
    this.missing = event;
    if (!this.isFilling) void this.fill();
  }

  /** @returns whether all that the event tells is in the trails */
  private join({ robots }: Told): boolean {
    const gap = robots.filter(({ name, trailFrom, trail }) => !this.trails.merge(name, trailFrom, trail));
    return gap.length === 0;
  }

  private know({ revision, robots }: Told): void {
    this.known = revision;
    for (const { name, trailFrom, trail } of robots) this.counts.set(name, trailFrom + trail.length);
  }

  /** What waiting does not mend is left until an event finds the gap again, but not at the pace of events. */
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

  /** Page by page, from what is known; what has come stays when a later page fails. */
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
    throw new MalformedAnswer('the paths have fewer positions than a live event told of');
  }

  /** The server has less than it told of before: what is known of it is not to be relied on. */
  private forget(): void {
    this.known = 0;
    this.counts.clear();
  }
}
