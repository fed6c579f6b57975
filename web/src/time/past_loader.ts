/** Fetches the scans of a session page by page, and those that come while somebody looks. */
import type { TimedTrajectory } from '../api/history';
import { pagesOf } from '../api/path_pages';
import type { Timeline } from './timeline';

export interface PastSource {
  /** The scans after a revision, or the first of them. */
  fetchAfter(revision: number, signal: AbortSignal): Promise<TimedTrajectory>;
  /** The present is not reached yet. @param share how much is there, 0 to 1 */
  loading(share: number): void;
  /** All scans up to the present are there, for the first time or with those that have come since. */
  loaded(): void;
}

export class PastLoader {
  /** Up to this revision all is there. */
  private known = 0;
  private isWhole = false;

  /** @param newest the session's revision, as far as it has been heard of */
  constructor(
    private readonly timeline: Pick<Timeline, 'add'>,
    private readonly newest: () => number,
    private readonly source: PastSource,
  ) {}

  /** Up to the present. What has come stays when a later page fails: the next call goes on behind it. */
  async load(signal: AbortSignal): Promise<void> {
    const wanted = this.newest();
    if (this.isWhole && wanted <= this.known) return;
    const { source, timeline } = this;
    for await (const page of pagesOf(
      this.known,
      () => wanted,
      (revision) => source.fetchAfter(revision, signal),
    )) {
      if (signal.aborted) return;
      timeline.add(page.tracks);
      this.known = page.revision;
      if (!this.isWhole && this.known < wanted) source.loading(this.known / wanted);
    }
    this.isWhole = true;
    source.loaded();
  }
}
