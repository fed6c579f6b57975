/** Fetches the scans of a session page by page, then new ones. */
import type { TimedTrajectory } from '../api/history';
import { pagesOf } from '../api/path_pages';
import type { Timeline } from './timeline';

export interface PastSource {
  /** Fetches the first scans after a revision. */
  fetchAfter(revision: number, signal: AbortSignal): Promise<TimedTrajectory>;
  /** More pages follow. @param share loaded part, 0 to 1 */
  loading(share: number): void;
  /** All scans up to the present are loaded, for the first time or after an update. */
  loaded(): void;
}

export class PastLoader {
  /** The scans are complete up to this revision. */
  private known = 0;
  private isWhole = false;

  /** @param newest the session's newest known revision */
  constructor(
    private readonly timeline: Pick<Timeline, 'add'>,
    private readonly newest: () => number,
    private readonly source: PastSource,
  ) {}

  /**
   * Loads all pages up to the present. Loaded pages stay when a later page fails: the next call continues after them.
   */
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
