/** What the charts show of one answer, and what two answers tell together: rates and quantiles. */
import { parseNumber, type Samples } from './prometheus';

/** Cumulative, as Prometheus has them. */
export interface Bucket {
  /** Upper bound, seconds; the last is infinite. */
  le: number;
  count: number;
}

/** Null: this server does not tell. */
export interface Measures {
  /** Since the epoch, seconds. */
  time: number;
  /** When the process started, seconds since the epoch. */
  started: number | null;
  scans: number | null;
  /** Time between a scan's arrival and its acknowledgement; buckets by rising bound. */
  ack: Bucket[] | null;
  inFlight: number | null;
  queuedBytes: number | null;
  cpuSeconds: number | null;
  memoryBytes: number | null;
}

/** Answers further apart than this say nothing of the time between them. */
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

/** Stands for an answer that did not come. */
export function nothingMeasured(time: number): Measures {
  return measure(new Map(), time);
}

/** Over all labels; null where there is no such metric, or no number. */
export function total(samples: Samples, name: string): number | null {
  const all = samples.get(name);
  if (!all) return null;
  const sum = all.reduce((before, { value }) => before + value, 0);
  return Number.isFinite(sum) ? sum : null;
}

/** A histogram over all labels but the bound's. */
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

/** Whether the two are of one run of the server, and near enough to be compared. */
export function comparable(before: Measures, after: Measures): boolean {
  const elapsed = after.time - before.time;
  return elapsed > 0 && elapsed <= kGapSeconds && before.started === after.started;
}

/** A counter's rise per second; null where it cannot be told, as after a restart: counters never fall. */
export function rate(before: Measures, after: Measures, counter: 'scans' | 'cpuSeconds'): number | null {
  const from = before[counter];
  const to = after[counter];
  if (from === null || to === null || to < from || !comparable(before, after)) return null;
  return (to - from) / (after.time - before.time);
}

/** What was observed between the two; null where that cannot be told. */
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
 * The value below which the given part of the observations lies, evenly spread within a bucket as Prometheus has it.
 *
 * @param q 0..1
 * @return null when nothing was observed; the highest finite bound for what lies above it
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
