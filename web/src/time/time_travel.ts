/** The way to a moment of the past: one at a time, and of those that are wanted meanwhile only the newest. */
import { isPassing, Refused } from '../api/http';
import type { Weave } from '../api/weaves';
import type { MapSource } from '../map/map_source';
import { backoff } from '../poll';
import type { Weaver } from './weaver';

/** Most weaves go on from the one before and are there by then. Each question waits longer than the one before. */
const kAskFirstMs = 15;
const kAskLastMs = 400;
/** What takes longer than this is told, and is given up when something earlier is wanted. */
const kLongMs = 300;
/** Whether the shown maps are still there is asked as often as this, which also keeps them. */
const kKeepMs = 10_000;
const kRetryMs = 500;
/** Moments that are kept to go back to: the server keeps a few dozen weaves, which are not all for this. */
const kKeptMax = 12;

export interface TravelEvents {
  arrived(revision: number, source: MapSource): void;
  /** It takes long: entries of the log that are woven, of how many. */
  weaving(woven: number, until: number): void;
  /** @param trying whether it is tried again by itself */
  failed(error: unknown, trying: boolean): void;
  /** Nothing is under way any more. */
  rested(): void;
}

export interface Timer {
  /** Milliseconds, from whenever it likes. */
  now(): number;
  rest(durationMs: number): Promise<void>;
}

/** The weave ended without maps. */
export class Unwoven extends Error {
  override name = 'Unwoven';
}

export class TimeTravel {
  private wanted: number | null = null;
  private shown: { revision: number; weave: string } | null = null;
  private underWay = false;
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
    if (!this.underWay) void this.travel();
  }

  /** Nowhere any more: what is under way is given up. */
  stop(): void {
    this.wanted = null;
    this.shown = null;
  }

  private async travel(): Promise<void> {
    this.underWay = true;
    let failures = 0;
    while (this.isOnTheWay()) {
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
        if (this.isOnTheWay()) await this.timer.rest(backoff(kRetryMs, failures));
      }
    }
    this.underWay = false;
    if (!this.signal.aborted) this.events.rested();
  }

  private isOnTheWay(): boolean {
    return !this.isOver() && this.wanted !== this.shown?.revision;
  }

  private isOver(): boolean {
    return this.signal.aborted || this.wanted === null;
  }

  private async reach(revision: number): Promise<void> {
    const weave = await this.weave(revision);
    if (weave === null || this.isOver()) return;
    const source = await this.weaver.load(weave.id, (error) => void this.lose(error));
    if (this.isOver()) return;
    this.shown = { revision, weave: weave.id };
    this.kept.delete(weave.id);
    this.kept.add(weave.id);
    this.forget(kKeptMax);
    this.events.arrived(revision, source);
  }

  /** Gives back to the server all but so many, the oldest first. */
  private forget(keptMax: number): void {
    for (const weave of this.kept) {
      if (this.kept.size <= keptMax) return;
      this.kept.delete(weave);
      void this.weaver.cancel(weave).catch(() => {});
    }
  }

  /** @returns null: it was given up, as something else is wanted */
  private async weave(revision: number): Promise<Weave | null> {
    const start = this.timer.now();
    let weave = await this.weaver.start(revision);
    for (let wait = kAskFirstMs; isUnderWay(weave); wait = Math.min(2 * wait, kAskLastMs)) {
      const isLong = this.timer.now() - start > kLongMs;
      if (this.isOver() || (isLong && (this.wanted ?? revision) < revision)) {
        void this.weaver.cancel(weave.id).catch(() => {});
        return null;
      }
      if (isLong) this.events.weaving(weave.woven, weave.until);
      await this.timer.rest(wait);
      weave = await this.weaver.progress(weave.id);
    }
    if (weave.state === 'failed') throw new Unwoven(weave.reason);
    if (weave.state === 'cancelled') throw new Refused(404, weave.reason);
    return weave;
  }

  /** Something of the shown maps cannot be had: they are asked for again, by the same way. */
  private async lose(error: unknown): Promise<void> {
    if (this.isOver() || this.shown === null) return;
    const trying = mayGoBetter(error);
    this.events.failed(error, trying);
    if (!trying) return;
    this.shown = null;
    await this.timer.rest(kRetryMs);
    if (!this.underWay) void this.travel();
  }

  /** The server keeps those weaves that were used last. One that is gone nevertheless is woven again. */
  private async keep(): Promise<void> {
    while (!this.signal.aborted) {
      await this.timer.rest(kKeepMs);
      const { shown } = this;
      if (this.signal.aborted || this.underWay || shown === null) continue;
      try {
        await this.weaver.progress(shown.weave);
      } catch (error) {
        const isGone = error instanceof Refused && error.status === 404;
        if (isGone && shown === this.shown) void this.lose(error);
      }
    }
  }
}

function isUnderWay({ state }: Weave): boolean {
  return state === 'waiting' || state === 'weaving';
}

/** Also when the weave went before it was shown. */
function mayGoBetter(error: unknown): boolean {
  return isPassing(error) || (error instanceof Refused && error.status === 404);
}
