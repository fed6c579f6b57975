/**
 * The cost of a scan for the whole service, from a robot's socket to its ack, compared with the lower bound of any
 * service.
 *
 *   SCANLOOM_BIN_DIR=build/bin node tests/bench/service_bench.mjs build/bench/link_bench build/bench/service.json [--quick]
 *
 * Everything is enabled: durable log, occupancy, HIMM, classes; scans of 684 beams, cells of 0.05 m. The generator runs
 * on the same machine; its CPU use is printed, too.
 */
import { execFileSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { load, startServer } from './load_runs.mjs';
import { announce, fullOrQuick, operands } from './report/arguments.mjs';
import { describe, machineWithStore } from './report/machine.mjs';
import { table, threeDigits } from './report/table.mjs';

const aims = { cpuMicroseconds: 25, ackMilliseconds: 100, liveRobots: 5000 };
const kSeconds = fullOrQuick(10, 2);
const kBatch = 10;
const kRobots = 128; // the tool sends at most 1000 scans a second for each robot

const [linkBench, file] = operands;
announce('service', '2 minutes', '1 minute');
const on = machineWithStore();
const link = measureLink();
const full = await measure({ robots: kRobots, rate: 0, batch: kBatch });
const rate = (0.8 * full.scans.acknowledged_per_second) / kRobots;
const most = await measure({ robots: kRobots, rate: rate.toFixed(2), batch: kBatch });
const live = await measure({
  robots: aims.liveRobots,
  rate: 10,
  batch: kBatch,
  'connections-per-second': 1000,
  verify: 'counts',
});
const single = await measure({ robots: 100, rate: 10, batch: 1 });
writeFileSync(file, `${JSON.stringify({ machine: on, aims, link, full, most, live, single }, null, 2)}\n`);
printTables();

async function measure(options) {
  const server = await startServer();
  try {
    return await load(server, { duration: kSeconds, world: 'room', 'cell-size': 0.05, ...options });
  } finally {
    await server.stop();
  }
}

/** @returns {read, parse}: CPU microseconds of the reader for a frame of one scan */
function measureLink() {
  const run = JSON.parse(
    execFileSync(linkBench, ['--benchmark_format=json'], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }),
  );
  const of = (name) => run.benchmarks.find((benchmark) => benchmark.name === name).cpu_time;
  return { read: of('ReadFrames'), parse: of('ReadAndParseFrames') };
}

/** Latency from the intended times; without them (rate 0) from sending. */
function ackOf(run) {
  return run.ack_from_intended ?? run.ack_from_sending;
}

function printTables() {
  const row = (name, run) => [
    name,
    run.scans.acknowledged_per_second.toFixed(0),
    threeDigits(run.server.cpu_us_per_scan),
    threeDigits(run.server.cores),
    threeDigits(run.generator.cores),
    threeDigits(ackOf(run).p50_ms),
    threeDigits(ackOf(run).p99_ms),
    run.own_delay ? threeDigits(run.own_delay.p99_ms) : '',
    (run.server.resident_bytes / 2 ** 20).toFixed(0),
  ];
  console.log(describe(on), '\n');
  console.log(
    table(
      [
        '',
        'scans/s',
        'server, us a scan',
        'server, cores',
        'generator, cores',
        'ack p50, ms',
        'p99, ms',
        'generator late, p99, ms',
        'server, MiB',
      ],
      [
        row(`${kRobots} robots as fast as they may, ${kBatch} scans a frame`, full),
        row('the same robots at 80 % of that', most),
        row(`${aims.liveRobots} robots, 10 Hz, ${kBatch} scans a frame`, live),
        row('100 robots, 10 Hz, a scan a frame', single),
      ],
    ),
  );
  console.log(
    `\nserver CPU a scan: ${threeDigits(full.server.cpu_us_per_scan)} us (aim: at most ${aims.cpuMicroseconds}); reading a frame alone ${threeDigits(link.read)}, reading and parsing ${threeDigits(link.parse)}`,
  );
  console.log(
    `ack p99 at 80 %: ${threeDigits(most.ack_from_sending.p99_ms)} ms from sending, ${threeDigits(most.ack_from_intended.p99_ms)} from the intended time of each scan of a frame (aim: below ${aims.ackMilliseconds})`,
  );
  console.log(
    `${aims.liveRobots} robots at 10 Hz: ${live.scans.acknowledged} of ${live.scans.due} scans, the generator took ${threeDigits(live.generator.cores)} cores of ${on.cores}`,
  );
  console.log(`written to ${file}`);
}
