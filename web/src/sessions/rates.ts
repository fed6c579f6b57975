/** Each session's scans per second over the last few seconds, from the counts of successive answers. */
import type { Session } from '../api/types';

/** Long enough to be stable at one poll in two seconds, short enough to be current. */
const kWindowMs = 10_000;

interface Count {
  atMs: number;
  scans: number;
}

interface History {
  id: string;
  /** Oldest first. */
  counts: Count[];
}

export class SessionRates {
  private readonly histories = new Map<string, History>();

  /**
   * @param sessions all sessions; others are forgotten
   * @param nowMs of a monotonic clock
   */
  learn(sessions: Session[], nowMs: number): void {
    const names = new Set(sessions.map(({ name }) => name));
    for (const name of this.histories.keys()) if (!names.has(name)) this.histories.delete(name);
    for (const session of sessions) this.add(session, nowMs);
  }

  /** @return scans per second; null after a single answer */
  of(name: string): number | null {
    const counts = this.histories.get(name)?.counts ?? [];
    const first = counts[0];
    const last = counts[counts.length - 1];
    if (!first || !last || last.atMs <= first.atMs) return null;
    return ((last.scans - first.scans) * 1000) / (last.atMs - first.atMs);
  }

  private add({ name, id, scans }: Session, atMs: number): void {
    const known = this.histories.get(name);
    const before = known?.id === id ? known.counts : [];
    const newest = before[before.length - 1];
    // An answer was overtaken, or the log was recomputed: the earlier counts cannot be compared.
    const comparable = newest && newest.scans > scans ? [] : before;
    const counts = [...comparable.filter((count) => atMs - count.atMs <= kWindowMs), { atMs, scans }];
    this.histories.set(name, { id, counts });
  }
}
