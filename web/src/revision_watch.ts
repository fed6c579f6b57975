/** Keeps a resource of the server up to date by its revision while it is shown. */

/** Minimum time between two fetches, which cost the server work. */
const kPauseMs = 1_000;

export class RevisionWatch<Thing> {
  private wanted = 0;
  private shown = -1;
  private fetching = false;
  private enabled = false;
  private invalidations = 0;

  constructor(
    private readonly load: (signal: AbortSignal) => Promise<Thing>,
    private readonly show: (thing: Thing) => void,
    private readonly signal: AbortSignal,
  ) {}

  /** @param revision from the live connection */
  setRevision(revision: number): void {
    this.wanted = revision;
    this.update();
  }

  enable(enabled: boolean): void {
    this.enabled = enabled;
    this.update();
  }

  /** The server may have restarted; its revisions cannot be compared with those before: fetch again. */
  invalidate(): void {
    this.invalidations += 1;
    this.shown = -1;
  }

  private update(): void {
    if (this.enabled && !this.fetching && this.wanted !== this.shown && !this.signal.aborted) void this.fetch();
  }

  private async fetch(): Promise<void> {
    this.fetching = true;
    const revision = this.wanted;
    const { invalidations } = this;
    try {
      const thing = await this.load(this.signal);
      if (this.signal.aborted) return;
      if (invalidations === this.invalidations) this.shown = revision;
      this.show(thing);
    } catch {
      // Other parts of the page report connection errors; the fetch is repeated.
    }
    await new Promise((resolve) => setTimeout(resolve, kPauseMs));
    this.fetching = false;
    this.update();
  }
}
