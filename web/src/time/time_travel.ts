/** Shows the map of an earlier time: one request at a time; of newer requests only the last is kept. */
import { isPassing, Refused } from '../api/http';
import type { Weave } from '../api/weaves';
import type { MapSource } from '../map/map_source';
import { backoff } from '../poll';
import type { Weaver } from './weaver';

/** Most weaves extend the previous one and are ready by then. Each poll waits longer than the one before. */
const kAskFirstMs = 15;
const kAskLastMs = 400;
/** A weave that takes longer reports progress, and is cancelled when an earlier moment is requested. */
const kLongMs = 300;
/** Interval of checks whether the server still has the shown maps; a check also keeps them there. */
const kKeepMs = 10_000;
const kRetryMs = 500;
/** Weaves that are kept to return to: the server keeps a few dozen for all users. */
const kKeptMax = 12;

export interface TravelEvents {
  arrived(revision: number, source: MapSource): void;
  /** The weave takes long: log entries applied so far and in total. */
  weaving(applied: number, until: number): void;
  /** @param trying whether the request is retried automatically */
  failed(error: unknown, trying: boolean): void;
  /** No request is pending. */
  rested(): void;
}

export interface Timer {
  /** Milliseconds of any monotonic clock. */
  now(): number;
  rest(durationMs: number): Promise<void>;
}

/** The weave ended without maps. */
export class WeaveFailed extends Error {
  override name = 'WeaveFailed';
}

export class TimeTravel {
  private wanted: number | null = null;
  private shown: { revision: number; weave: string } | null = null;
  private travelling = false;
  /** Increases when the weaver's requests change. */
  private round = 0;
  /** Weaves of moments that were shown, the newest last. */
  private readonly kept = new Set<string>();

  constructor(
    private readonly weaver: Weaver,
    private readonly events: TravelEvents,
    private readonly signal: AbortSignal,
    private readonly timer: Timer,
  ) {
    void this.keep();
    signal.addEventListener('abort', () => this.forget(0));
  }

  go(revision: number): void {
    this.wanted = revision;
    if (!this.travelling) void this.travel();
  }

  /** The weaver's requests have changed: the next go() requests its moment again, even if it is shown. */
  invalidate(): void {
    this.round += 1;
    this.shown = null;
  }

  /** Returns to the present: cancels pending requests. */
  stop(): void {
    this.wanted = null;
    this.shown = null;
  }

  private async travel(): Promise<void> {
    this.travelling = true;
    let failures = 0;
    while (this.isPending()) {
      const revision = this.wanted ?? 0;
      try {
        await this.reach(revision);
        failures = 0;
      } catch (error) {
        if (this.isOver()) break;
        const trying = mayGoBetter(error);
        this.events.failed(error, trying);
        if (!trying && this.wanted === revision) this.wanted = this.shown?.revision ?? null;
        failures += 1;
        if (this.isPending()) await this.timer.rest(backoff(kRetryMs, failures));
      }
    }
    this.travelling = false;
    if (!this.signal.aborted) this.events.rested();
  }

  private isPending(): boolean {
    return !this.isOver() && this.wanted !== this.shown?.revision;
  }

  private isOver(): boolean {
    return this.signal.aborted || this.wanted === null;
  }

  private async reach(revision: number): Promise<void> {
    const { round } = this;
    const weave = await this.weave(revision);
    if (weave === null || this.isOver()) return;
    const source = await this.weaver.load(weave.id, (error) => void this.lose(error));
    if (this.isOver()) return;
    this.kept.delete(weave.id);
    this.kept.add(weave.id);
    this.forget(kKeptMax);
    if (round !== this.round) return;
    this.shown = { revision, weave: weave.id };
    this.events.arrived(revision, source);
  }

  /** Deletes the oldest weaves on the server, and keeps this many. */
  private forget(keptMax: number): void {
    for (const weave of this.kept) {
      if (this.kept.size <= keptMax) return;
      this.kept.delete(weave);
      void this.weaver.cancel(weave).catch(() => {});
    }
  }

  /** @returns null: cancelled, because another moment was requested, or the same one with other poses */
  private async weave(revision: number): Promise<Weave | null> {
    const { round } = this;
    const start = this.timer.now();
    let weave = await this.weaver.start(revision);
    for (let wait = kAskFirstMs; isUnfinished(weave); wait = Math.min(2 * wait, kAskLastMs)) {
      const isLong = this.timer.now() - start > kLongMs;
      const isObsolete = round !== this.round || (this.wanted ?? revision) < revision;
      if (this.isOver() || (isLong && isObsolete)) {
        void this.weaver.cancel(weave.id).catch(() => {});
        return null;
      }
      if (isLong) this.events.weaving(weave.applied, weave.until);
      await this.timer.rest(wait);
      weave = await this.weaver.progress(weave.id);
    }
    if (weave.state === 'failed') throw new WeaveFailed(weave.reason);
    if (weave.state === 'cancelled') throw new Refused(404, weave.reason);
    return weave;
  }

  /** Tiles of the shown maps failed: load the moment again. */
  private async lose(error: unknown): Promise<void> {
    if (this.isOver() || this.shown === null) return;
    const trying = mayGoBetter(error);
    this.events.failed(error, trying);
    if (!trying) return;
    this.shown = null;
    await this.timer.rest(kRetryMs);
    if (!this.travelling) void this.travel();
  }

  /** The server keeps the most recently used weaves. A missing one is computed again. */
  private async keep(): Promise<void> {
    while (!this.signal.aborted) {
      await this.timer.rest(kKeepMs);
      const { shown } = this;
      if (this.signal.aborted || this.travelling || shown === null) continue;
      try {
        await this.weaver.progress(shown.weave);
      } catch (error) {
        const isGone = error instanceof Refused && error.status === 404;
        if (isGone && shown === this.shown) void this.lose(error);
      }
    }
  }
}

function isUnfinished({ state }: Weave): boolean {
  return state === 'waiting' || state === 'weaving';
}

/** Also called when the weave is gone before it was shown. */
function mayGoBetter(error: unknown): boolean {
  return isPassing(error) || (error instanceof Refused && error.status === 404);
}
