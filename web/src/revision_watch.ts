/** Keeps something of the server's as new as its revision, as long as somebody looks at it. */

/** What is fetched is work for the server: no more often than this. */
const kPauseMs = 1_000;

export class RevisionWatch<Thing> {
  private wanted = 0;
  private shown = -1;
  private underWay = false;
  private enabled = false;
  private doubts = 0;

  constructor(
    private readonly load: (signal: AbortSignal) => Promise<Thing>,
    private readonly show: (thing: Thing) => void,
    private readonly signal: AbortSignal,
  ) {}

  /** @param revision as the live connection tells it */
  hear(revision: number): void {
    this.wanted = revision;
    this.update();
  }

  enable(enabled: boolean): void {
    this.enabled = enabled;
    this.update();
  }

  /** What is shown may be of another server's life, whose revisions are not to be compared with these. */
  doubt(): void {
    this.doubts += 1;
    this.shown = -1;
  }

  private update(): void {
    if (this.enabled && !this.underWay && this.wanted !== this.shown && !this.signal.aborted) void this.fetch();
  }

  private async fetch(): Promise<void> {
    this.underWay = true;
    const revision = this.wanted;
    const { doubts } = this;
    try {
      const thing = await this.load(this.signal);
      if (this.signal.aborted) return;
      if (doubts === this.doubts) this.shown = revision;
      this.show(thing);
    } catch {
      // The connection's state is told elsewhere; it is asked for again.
    }
    await new Promise((resolve) => setTimeout(resolve, kPauseMs));
    this.underWay = false;
    this.update();
  }
}
