/**
 * The cost of maps with estimated poses: CPU of a scan compared with a plain Bresenham mapper, the time until a scan has
 * its pose, memory, a robot that stands, where the time goes, and how long acknowledgements take compared with those of
 * robots that send poses.
 *
 *   SCANLOOM_BIN_DIR=build/bin node tests/bench/localization_bench.mjs build/bench/localization_bench build/bench/localization.json [LOG] [--quick]
 *
 * Without a CARMEN log, the scans are those of a simulated drive through an office. Each run is a process of its own;
 * runs with different poses alternate, and medians over the rounds count. Times are CPU time, not wall time, except those
 * of acknowledgements.
 */
import { execFileSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { basename } from 'node:path';
import { load, startServer } from './load_runs.mjs';
import { announce, fullOrQuick, operands } from './report/arguments.mjs';
import { describe, machineWithStore } from './report/machine.mjs';
import { table, threeDigits } from './report/table.mjs';

const kPoses = ['map', 'odometry', 'none'];
const kEstimated = kPoses.slice(1);
const kRounds = fullOrQuick(5, 1);
const kScans = fullOrQuick(1_000_000, 600);
const kStandingScans = fullOrQuick(6000, 300); // ten minutes at 10 Hz
const kArrivalMicroseconds = 10_000; // 100 scans a second
const kAckRounds = fullOrQuick(9, 1);
const kFleet = { robots: 20, rate: 10, batch: 1, duration: fullOrQuick(10, 2), verify: 'counts' };

const aims = {
  overBresenham: 18, // maximum
  addedMilliseconds99: 10, // 99 % of the scans
  addedMilliseconds: 50, // maximum
  bytesPerScan: 3000,
  ackOverMap: 1.5, // maximum, of the 99th percentiles
};

const [program, file, log] = operands;
announce('localization', '6 minutes', 'half a minute');
const on = machineWithStore();
const rounds = Array.from({ length: kRounds }, () =>
  Object.fromEntries(kPoses.map((poses) => [poses, run('measure', poses)])),
);
const costs = Object.fromEntries(kPoses.map((poses) => [poses, costOf(poses)]));
const stages = Object.fromEntries(kEstimated.map((poses) => [poses, run('sample', poses)]));
const standing = Object.fromEntries(kEstimated.map((poses) => [poses, run('stand', poses, kStandingScans)]));
const acks = await measureAcks();
writeFileSync(
  file,
  `${JSON.stringify({ machine: on, log: nameOfDrive(), aims, costs, stages, standing, acks }, null, 2)}\n`,
);
printTables();

function run(what, poses, scans = kScans) {
  const operand = what === 'stand' || !log ? [] : [log];
  return JSON.parse(
    execFileSync(program, [what, poses, String(scans), ...operand], { encoding: 'utf8', maxBuffer: 2 ** 28 }),
  );
}

function costOf(poses) {
  const runs = rounds.map((round) => round[poses]);
  const { scans, beams, graph, corrections, chunks } = runs[0];
  const microseconds = median(runs.map((each) => mean(each.microseconds)));
  const cost = {
    scans,
    beams,
    graph,
    corrections,
    chunks,
    microseconds,
    over_bresenham: median(runs.map((each) => mean(each.microseconds) / each.bresenham_microseconds)),
    bresenham_microseconds: median(runs.map((each) => each.bresenham_microseconds)),
    correction_microseconds: median(runs.map((each) => (each.correction_seconds * 1e6) / scans)),
    corrected_over_bresenham: median(
      runs.map(
        (each) => (mean(each.microseconds) + (each.correction_seconds * 1e6) / scans) / each.bresenham_microseconds,
      ),
    ),
  };
  if (poses === 'map') return cost;
  const added = addedMilliseconds(poses);
  return {
    ...cost,
    added_ms: { p50: percentile(added, 50), p99: percentile(added, 99), max: percentile(added, 100) },
    scans_over_limit: added.filter((each) => each >= aims.addedMilliseconds99).length,
    bytes_per_scan: median(rounds.map((round) => (round[poses].resident_bytes - round.map.resident_bytes) / scans)),
    allocated_bytes_per_scan: median(runs.map((each) => (each.allocated_bytes - each.allocated_bytes_of_maps) / scans)),
  };
}

/** How much later each scan has its pose and is in the maps than with `map`, in increasing order. */
function addedMilliseconds(poses) {
  const latencies = latenciesOf(poses);
  const ofMap = latenciesOf('map');
  return latencies.map((each, n) => (each - ofMap[n]) / 1000).sort((a, b) => a - b);
}

/** Latencies in microseconds of scans that arrive 100 times a second and wait for the earlier ones. */
function latenciesOf(poses) {
  let free = 0;
  return rounds[0][poses].microseconds.map((_, n) => {
    const arrival = n * kArrivalMicroseconds;
    free = Math.max(free, arrival) + median(rounds.map((round) => round[poses].microseconds[n]));
    return free - arrival;
  });
}

/** Alternates runs of robots that send poses and robots that send odometry. */
async function measureAcks() {
  const pairs = [];
  for (let round = 0; round < kAckRounds; ++round) {
    const pair = {};
    for (const poses of round % 2 === 0 ? ['map', 'odometry'] : ['odometry', 'map']) {
      const server = await startServer();
      try {
        const { ack_from_intended, server: use, own_delay } = await load(server, { ...kFleet, poses });
        pair[poses] = {
          ...ack_from_intended,
          cpu_us_per_scan: use.cpu_us_per_scan,
          own_delay_p99_ms: own_delay.p99_ms,
        };
      } finally {
        await server.stop();
      }
    }
    pairs.push({ ...pair, p99_over_map: pair.odometry.p99_ms / pair.map.p99_ms });
  }
  return { pairs, p99_over_map: median(pairs.map((pair) => pair.p99_over_map)) };
}

function nameOfDrive() {
  return log ? basename(log) : 'a simulated drive through an office';
}

function printTables() {
  console.log(describe(on), '\n');
  console.log(
    `${nameOfDrive()}: ${costs.map.scans} scans of ${costs.map.beams} beams, cells of 0.05 m, all layers; CPU time, medians of ${kRounds} rounds\n`,
  );
  const row = (name, valueOf, poses = kPoses) => [
    name,
    ...kPoses.map((each) => (poses.includes(each) ? valueOf(costs[each]) : '')),
  ];
  console.log(
    table(
      ['poses', ...kPoses],
      [
        row('pose and maps of a scan, us', (of) => threeDigits(of.microseconds)),
        row('Bresenham mapper, the same scans and poses, us', (of) => threeDigits(of.bresenham_microseconds)),
        row('times as long as that', (of) => threeDigits(of.over_bresenham)),
        row('maps made again, us a scan', (of) => threeDigits(of.correction_microseconds), kEstimated),
        row('together, times as long as Bresenham', (of) => threeDigits(of.corrected_over_bresenham)),
        row('corrections of the maps', (of) => of.corrections, kEstimated),
        row('keyframes', (of) => of.graph.keyframes, kEstimated),
        row('loops', (of) => of.graph.loops, kEstimated),
        row('added latency at 100 scans/s, p50, ms', (of) => threeDigits(of.added_ms.p50), kEstimated),
        row('p99, ms', (of) => threeDigits(of.added_ms.p99), kEstimated),
        row('maximum, ms', (of) => threeDigits(of.added_ms.max), kEstimated),
        row('resident memory, bytes a scan more than map', (of) => of.bytes_per_scan.toFixed(0), kEstimated),
        row('allocated, bytes a scan, without the maps', (of) => of.allocated_bytes_per_scan.toFixed(0), kEstimated),
      ],
    ),
  );
  console.log('\nWhere the CPU time goes, %, by samples of call stacks; without the maps that are made again\n');
  console.log(
    table(
      ['', ...kEstimated],
      Object.keys(stages.odometry).map((stage) => [
        stage,
        ...kEstimated.map((poses) => (100 * stages[poses][stage]).toFixed(1)),
      ]),
    ),
  );
  console.log(
    `\nacknowledgements, ${kFleet.robots} robots at ${kFleet.rate} Hz, one scan a frame, a session each, ms\n`,
  );
  console.log(
    table(
      ['', 'map p50', 'odometry p50', 'map p99', 'odometry p99', 'ratio of p99'],
      acks.pairs.map(({ map, odometry, p99_over_map }, n) => [
        `pair ${n + 1}`,
        ...[map.p50_ms, odometry.p50_ms, map.p99_ms, odometry.p99_ms, p99_over_map].map(threeDigits),
      ]),
    ),
  );
  printLimits();
  console.log(`written to ${file}`);
}

function printLimits() {
  const worst = (valueOf) => Math.max(...kEstimated.map((poses) => valueOf(costs[poses])));
  console.log(
    `\ntimes as long as a Bresenham mapper: ${threeDigits(worst((of) => of.over_bresenham))}, with the maps made again ${threeDigits(worst((of) => of.corrected_over_bresenham))} (aim: at most ${aims.overBresenham})`,
  );
  console.log(
    `added latency: p99 ${threeDigits(worst((of) => of.added_ms.p99))} ms (aim: below ${aims.addedMilliseconds99}), maximum ${threeDigits(worst((of) => of.added_ms.max))} (aim: at most ${aims.addedMilliseconds}), ${worst((of) => of.scans_over_limit)} scans of ${aims.addedMilliseconds99} ms or more`,
  );
  console.log(`memory: ${worst((of) => of.bytes_per_scan).toFixed(0)} bytes a scan (aim: below ${aims.bytesPerScan})`);
  for (const poses of kEstimated) {
    const { before, after, scans } = standing[poses];
    console.log(
      `standing for ${scans} scans, ${poses}: ${after.keyframes - before.keyframes} new keyframes, of which submaps consist, ${after.edges - before.edges} new edges (aim: none)`,
    );
  }
  console.log(
    `p99 of acknowledgements: ${threeDigits(acks.p99_over_map)} times that with map, median of ${kAckRounds} pairs (aim: at most ${aims.ackOverMap})`,
  );
}

function mean(values) {
  return values.reduce((sum, value) => sum + value, 0) / values.length;
}

function median(values) {
  return percentile(
    [...values].sort((a, b) => a - b),
    50,
  );
}

/** Pre: the values increase. */
function percentile(values, percent) {
  return values[Math.min(values.length - 1, Math.floor((values.length * percent) / 100))];
}
