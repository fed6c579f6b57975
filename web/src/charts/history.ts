/** The server's metrics of the last minutes, as series for the charts. */
import { comparable, observedBetween, quantile, rate, type Measures } from './measures';

export const kHistorySeconds = 300;
/** Number of answers over which latencies are computed: between two answers there may be too few scans. */
const kLatencySeconds = 10;

export type Series = (number | null)[];

/** One value for each time; null is a gap. */
export interface SeriesOfTime {
  /** Seconds since the epoch, increasing. */
  times: number[];
  /** Per second. */
  scans: Series;
  /** Seconds. */
  ackMedian: Series;
  ackSlow: Series;
  inFlight: Series;
  queuedBytes: Series;
  /** Per cent of one core. */
  cpu: Series;
  memoryBytes: Series;
}

export class History {
  private measures: Measures[] = [];

  /** Adds a sample. Samples from before a clock was set back are dropped. */
  add(measures: Measures): void {
    const recent = ({ time }: Measures): boolean => time < measures.time && measures.time - time <= kHistorySeconds;
    this.measures = [...this.measures.filter(recent), measures];
  }

  /** Whether any of the answers contained the metric. */
  has(what: keyof Measures): boolean {
    return this.measures.some((each) => each[what] !== null);
  }

  series(): SeriesOfTime {
    const all = this.measures;
    const sincePrevious = (counter: 'scans' | 'cpuSeconds', scale: number): Series =>
      all.map((each, index) => {
        const before = all[index - 1];
        const perSecond = before ? rate(before, each, counter) : null;
        return perSecond === null ? null : perSecond * scale;
      });
    return {
      times: all.map(({ time }) => time),
      scans: sincePrevious('scans', 1),
      ackMedian: all.map((_, index) => this.latency(0.5, index)),
      ackSlow: all.map((_, index) => this.latency(0.99, index)),
      inFlight: all.map(({ inFlight }) => inFlight),
      queuedBytes: all.map(({ queuedBytes }) => queuedBytes),
      cpu: sincePrevious('cpuSeconds', 100),
      memoryBytes: all.map(({ memoryBytes }) => memoryBytes),
    };
  }

  private latency(q: number, index: number): number | null {
    const after = this.measures[index];
    if (!after) return null;
    let oldest: Measures | null = null;
    for (let at = index - 1; at >= 0; --at) {
      const before = this.measures[at];
      if (!before || after.time - before.time > kLatencySeconds || !comparable(before, after)) break;
      if (observedBetween(before, after) === null) break;
      oldest = before;
    }
    const observed = oldest && observedBetween(oldest, after);
    return observed && quantile(q, observed);
  }
}
