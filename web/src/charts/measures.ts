/** The values that the charts show: of one answer, and of two answers together, such as rates and quantiles. */
import { parseNumber, type Samples } from './prometheus';

/** Cumulative counts, as in Prometheus. */
export interface Bucket {
  /** Upper bound, seconds; the last is infinite. */
  le: number;
  count: number;
}

/** Null: the server does not report it. */
export interface Measures {
  /** Since the epoch, seconds. */
  time: number;
  /** When the process started, seconds since the epoch. */
  started: number | null;
  scans: number | null;
  /** Time between a scan's arrival and its acknowledgement; buckets by increasing bound. */
  ack: Bucket[] | null;
  inFlight: number | null;
  queuedBytes: number | null;
  cpuSeconds: number | null;
  memoryBytes: number | null;
}

/** No rates are computed for answers that are further apart than this. */
const kGapSeconds = 12;

export function measure(samples: Samples, time: number): Measures {
  return {
    time,
    started: total(samples, 'process_start_time_seconds'),
    scans: total(samples, 'scanloom_scans_applied_total'),
    ack: buckets(samples, 'scanloom_ack_seconds'),
    inFlight: total(samples, 'scanloom_scans_in_flight'),
    queuedBytes: total(samples, 'scanloom_store_queued_bytes'),
    cpuSeconds: total(samples, 'process_cpu_seconds_total'),
    memoryBytes: total(samples, 'process_resident_memory_bytes'),
  };
}

/** Represents a missing answer. */
export function nothingMeasured(time: number): Measures {
  return measure(new Map(), time);
}

/** The sum over all labels; null where there is no such metric, or the sum is not finite. */
export function total(samples: Samples, name: string): number | null {
  const all = samples.get(name);
  if (!all) return null;
  const sum = all.reduce((before, { value }) => before + value, 0);
  return Number.isFinite(sum) ? sum : null;
}

/** A histogram, summed over all labels except the bound. */
export function buckets(samples: Samples, name: string): Bucket[] | null {
  const byBound = new Map<number, number>();
  for (const { labels, value } of samples.get(`${name}_bucket`) ?? []) {
    const le = parseNumber(labels.get('le'));
    if (le === null || Number.isNaN(le) || !Number.isFinite(value)) continue;
    byBound.set(le, (byBound.get(le) ?? 0) + value);
  }
  if (byBound.size === 0) return null;
  return [...byBound].map(([le, count]) => ({ le, count })).sort((a, b) => a.le - b.le);
}

/** Whether both answers are from one run of the server and close enough in time to be compared. */
export function comparable(before: Measures, after: Measures): boolean {
  const elapsed = after.time - before.time;
  return elapsed > 0 && elapsed <= kGapSeconds && before.started === after.started;
}

/** A counter's increase per second; null where it is unknown, as after a restart: counters never decrease. */
export function rate(before: Measures, after: Measures, counter: 'scans' | 'cpuSeconds'): number | null {
  const from = before[counter];
  const to = after[counter];
  if (from === null || to === null || to < from || !comparable(before, after)) return null;
  return (to - from) / (after.time - before.time);
}

/** The observations between the two answers; null where they are unknown. */
export function observedBetween(before: Measures, after: Measures): Bucket[] | null {
  if (!before.ack || !after.ack || !comparable(before, after)) return null;
  if (before.ack.length !== after.ack.length) return null;
  const difference: Bucket[] = [];
  for (const [index, { le, count }] of after.ack.entries()) {
    const old = before.ack[index];
    if (!old || old.le !== le || count < old.count) return null;
    difference.push({ le, count: count - old.count });
  }
  return difference;
}

/**
 * Returns the value below which the given part of the observations lies, linear within a bucket, as in Prometheus.
 *
 * @param q 0..1
 * @return null without observations; the highest finite bound for larger values
 */
export function quantile(q: number, histogram: Bucket[]): number | null {
  const all = histogram[histogram.length - 1]?.count ?? 0;
  if (all <= 0) return null;
  const rank = q * all;
  const index = histogram.findIndex(({ count }) => count >= rank && count > 0);
  const bucket = histogram[index];
  if (!bucket) return null;
  const below = histogram[index - 1];
  const floor = below?.le ?? 0;
  if (!Number.isFinite(bucket.le)) return below ? below.le : null;
  const within = bucket.count - (below?.count ?? 0);
  if (within <= 0) return bucket.le;
  return floor + ((bucket.le - floor) * (rank - (below?.count ?? 0))) / within;
}
