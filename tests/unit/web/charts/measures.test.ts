import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import * as measures from '../../../../web/src/charts/measures';
import { parseMetrics } from '../../../../web/src/charts/prometheus';

const kText = `
process_start_time_seconds 100
scanloom_scans_applied_total 50
scanloom_ack_seconds_bucket{robot="a",le="0.01"} 1
scanloom_ack_seconds_bucket{robot="b",le="0.01"} 3
scanloom_ack_seconds_bucket{robot="a",le="+Inf"} 2
scanloom_ack_seconds_bucket{robot="b",le="+Inf"} 3
scanloom_scans_in_flight{robot="a"} 1
scanloom_scans_in_flight{robot="b"} 2
process_cpu_seconds_total 1.5
process_resident_memory_bytes 1e6
`;

const at = (time: number, text = kText): measures.Measures => measures.measure(parseMetrics(text), time);
const scans = (time: number, count: number, started = 100): measures.Measures => {
  return { ...at(time), scans: count, started };
};

describe('a measurement', () => {
  it('is summed over labels and null if the server does not report it', () => {
    const { inFlight, queuedBytes, cpuSeconds, ack } = at(0);
    assert.deepEqual([inFlight, queuedBytes, cpuSeconds], [3, null, 1.5]);
    assert.deepEqual(ack, [
      { le: 0.01, count: 4 },
      { le: Infinity, count: 5 },
    ]);
    assert.equal(measures.nothingMeasured(0).ack, null);
  });

  it('is null if it is not a number', () => {
    assert.equal(at(0, 'scanloom_scans_in_flight NaN').inFlight, null);
    assert.equal(at(0, 'scanloom_ack_seconds_bucket 3').ack, null);
  });
});

describe('a rate', () => {
  it('is the increase per second', () => {
    assert.equal(measures.rate(scans(10, 50), scans(12, 80), 'scans'), 15);
  });

  it('is unknown across a server restart', () => {
    assert.equal(measures.rate(scans(10, 50), scans(12, 0), 'scans'), null);
    // The counter has caught up between two answers: only the start time differs.
    assert.equal(measures.rate(scans(10, 50), scans(12, 90, 111), 'scans'), null);
  });

  it('is unknown across a pause and before the first answer', () => {
    assert.equal(measures.rate(scans(10, 50), scans(40, 80), 'scans'), null);
    assert.equal(measures.rate(scans(10, 50), scans(10, 80), 'scans'), null);
    assert.equal(measures.rate(measures.nothingMeasured(10), scans(12, 80), 'scans'), null);
  });
});

describe('observations', () => {
  const ack = (time: number, ...counts: [number, number, number]): measures.Measures => {
    const bounds = [0.01, 0.1, Infinity];
    return { ...at(time), ack: counts.map((count, index) => ({ le: bounds[index] ?? 0, count })) };
  };

  it('are the difference between two answers', () => {
    const between = measures.observedBetween(ack(0, 4, 6, 6), ack(2, 5, 9, 10));
    assert.deepEqual(
      between?.map(({ count }) => count),
      [1, 3, 4],
    );
  });

  it('are unknown after a restart or with other buckets', () => {
    assert.equal(measures.observedBetween(ack(0, 4, 6, 6), ack(2, 5, 5, 5)), null);
    assert.equal(measures.observedBetween(at(0), ack(2, 5, 9, 10)), null);
    assert.equal(measures.observedBetween(at(0, ''), ack(2, 5, 9, 10)), null);
  });
});

describe('a quantile', () => {
  const histogram = (...pairs: [le: number, count: number][]): measures.Bucket[] =>
    pairs.map(([le, count]) => ({ le, count }));

  it('is interpolated linearly within its bucket', () => {
    const even = histogram([0.1, 50], [0.2, 100], [Infinity, 100]);
    assert.equal(measures.quantile(0.25, even), 0.05);
    assert.ok(Math.abs((measures.quantile(0.75, even) ?? 0) - 0.15) < 1e-12);
    assert.equal(measures.quantile(1, even), 0.2);
  });

  it('is null without observations', () => {
    assert.equal(measures.quantile(0.5, histogram([0.1, 0], [Infinity, 0])), null);
    assert.equal(measures.quantile(0.5, []), null);
  });

  it('beyond the last bound is the last bound', () => {
    assert.equal(measures.quantile(0.99, histogram([0.1, 1], [Infinity, 100])), 0.1);
    assert.equal(measures.quantile(0.5, histogram([Infinity, 3])), null);
  });
});
