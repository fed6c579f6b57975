/** Runs one task at a time: a newer task, or the end of the tool, aborts the previous one. */

export class NewestOnly {
  private now: AbortController | null = null;

  /**
   * @param changed called with whether a task is running
   * @param failed called with the error of a task that was not aborted
   */
  constructor(
    private readonly signal: AbortSignal,
    private readonly changed: (busy: boolean) => void,
    private readonly failed: (error: unknown) => void,
  ) {}

  get busy(): boolean {
    return this.now !== null;
  }

  run(task: (signal: AbortSignal) => Promise<void>): void {
    this.now?.abort();
    const controller = (this.now = new AbortController());
    this.changed(true);
    void this.follow(task(AbortSignal.any([this.signal, controller.signal])), controller);
  }

  stop(): void {
    this.now?.abort();
    this.now = null;
    this.changed(false);
  }

  private async follow(task: Promise<void>, controller: AbortController): Promise<void> {
    let error: unknown = null;
    try {
      await task;
    } catch (reason) {
      error = reason;
    }
    if (this.now !== controller || this.signal.aborted) return;
    this.now = null;
    this.changed(false);
    if (error !== null) this.failed(error);
  }
}
