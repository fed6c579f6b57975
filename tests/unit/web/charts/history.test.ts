import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { History } from '../../../../web/src/charts/history';
import { nothingMeasured, type Measures } from '../../../../web/src/charts/measures';

function at(time: number, rest: Partial<Measures> = {}): Measures {
  return { ...nothingMeasured(time), started: 1, ...rest };
}

const ack = (fast: number, all: number): Measures['ack'] => [
  { le: 0.01, count: fast },
  { le: 1, count: all },
  { le: Infinity, count: all },
];

describe('the measurement history', () => {
  it('has series of equal length with gaps for unknown values', () => {
    const history = new History();
    history.add(at(10, { scans: 0, cpuSeconds: 1, memoryBytes: 5 }));
    history.add(at(12, { scans: 20, cpuSeconds: 2, memoryBytes: 6 }));
    history.add(nothingMeasured(14));
    history.add(at(16, { scans: 60, cpuSeconds: 3, memoryBytes: 7 }));
    history.add(at(18, { scans: 5, cpuSeconds: 0, memoryBytes: 1, started: 17 }));
    history.add(at(20, { scans: 7, cpuSeconds: 1, memoryBytes: 2, started: 17 }));
    const { times, scans, cpu, memoryBytes } = history.series();
    assert.deepEqual(times, [10, 12, 14, 16, 18, 20]);
    assert.deepEqual(scans, [null, 10, null, null, null, 1]);
    assert.deepEqual(cpu, [null, 50, null, null, null, 50]);
    assert.deepEqual(memoryBytes, [5, 6, null, 7, 1, 2]);
  });

  it('computes latencies over some seconds, but not across a restart', () => {
    const history = new History();
    history.add(at(0, { ack: ack(0, 0) }));
    history.add(at(2, { ack: ack(100, 100) }));
    history.add(at(4, { ack: ack(100, 100) }));
    history.add(at(6, { ack: ack(2, 2), started: 5 }));
    history.add(at(8, { ack: ack(2, 2), started: 5 }));
    const { ackMedian, ackSlow } = history.series();
    assert.deepEqual(ackMedian, [null, 0.005, 0.005, null, null]);
    assert.ok(Math.abs((ackSlow[1] ?? 0) - 0.0099) < 1e-12);
  });

  it('covers five minutes and restarts when the clock is set back', () => {
    const history = new History();
    for (let time = 0; time <= 400; time += 2) history.add(at(time));
    assert.equal(history.series().times[0], 100);
    history.add(at(50));
    assert.deepEqual(history.series().times, [50]);
  });

  it('marks values that the server does not report', () => {
    const history = new History();
    history.add(at(0, { memoryBytes: 1 }));
    history.add(nothingMeasured(2));
    assert.ok(history.has('memoryBytes'));
    assert.ok(!history.has('ack'));
  });
});
