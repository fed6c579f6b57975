/** Keeps the frontiers on the map as new as the map, as long as somebody looks at them. */
import { fetchFrontiers } from './api/frontiers';
import type { Frontier } from './api/types';

/** Searching ways to all frontiers is work for the server: no more often than this. */
const kPauseMs = 1_000;

export class FrontierWatch {
  private wanted = 0;
  private shown = -1;
  private underWay = false;
  private enabled = false;

  constructor(
    private readonly session: string,
    private readonly show: (frontiers: Frontier[]) => void,
    private readonly signal: AbortSignal,
  ) {}

  /** @param revision of the frontiers, as the live connection tells it */
  hear(revision: number): void {
    this.wanted = revision;
    this.update();
  }

  enable(enabled: boolean): void {
    this.enabled = enabled;
    this.update();
  }

  private update(): void {
    if (this.enabled && !this.underWay && this.wanted !== this.shown && !this.signal.aborted) void this.load();
  }

  private async load(): Promise<void> {
    this.underWay = true;
    const revision = this.wanted;
    try {
      const frontiers = await fetchFrontiers(this.session, this.signal);
      if (this.signal.aborted) return;
      this.shown = revision;
      this.show(frontiers ?? []);
    } catch {
      // The connection's state is told elsewhere; it is asked for again.
    }
    await new Promise((resolve) => setTimeout(resolve, kPauseMs));
    this.underWay = false;
    this.update();
  }
}
