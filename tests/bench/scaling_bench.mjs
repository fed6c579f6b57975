/**
 * How cost grows with cells, beams, the map's extent, sessions, robots of one session, viewers and idle sessions;
 * memory with explored area; recovery with the log's length. Measures, prints and draws; a measured line parallel to
 * the dashed one is as expected.
 *
 *   SCANLOOM_BIN_DIR=build/bin node tests/bench/scaling_bench.mjs build/bench/scaling_bench build/bench/scaling.json build/bench/scaling.svg [--quick]
 */
import { execFileSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { load, startServer } from './load_runs.mjs';
import { announce, fullOrQuick, operands } from './report/arguments.mjs';
import { drawCharts } from './report/chart.mjs';
import { describe, machineWithStore } from './report/machine.mjs';
import { memoryBytes, processorSeconds } from './report/process_use.mjs';
import { table, threeDigits } from './report/table.mjs';

/** Total scans per second of all robots. */
const kScansPerSecond = 2000;
const kSeconds = fullOrQuick(6, 1);
const kMany = fullOrQuick([4, 16, 64, 256, 1024], [4, 64]);
const kRobots = fullOrQuick([4, 16, 64, 256], [4, 64]);
const kViewers = fullOrQuick([1, 16, 64, 256], [1, 64]);
const kRoom = { world: 'room', 'cell-size': 0.05, verify: 'counts' };
const kBusySessions = 8;
const kIdleSessions = fullOrQuick(2000, 200);
const kIdleRuns = fullOrQuick(3, 1); // the median counts
const kQuietCores = 0.02;
const kQuietSecondsMax = 60;

const [program, file, drawing] = operands;
announce('scaling', '4 minutes', 'half a minute');
const on = machineWithStore();
const kernels = measureKernels();
const extent = 'rooms of 100 square metres';
const charts = [
  {
    title: 'A scan, by cells',
    x: 'cells a metre',
    y: 'us',
    points: kernel('ScanByCellSize').map(([mm, us]) => [1000 / mm, us]),
    expected: 2,
  },
  { title: 'A scan, by beams', x: 'beams', y: 'us', points: kernel('ScanByBeams'), expected: 1 },
  { title: 'A scan, by extent, maps held', x: extent, y: 'us', points: kernel('ScanByExtent'), expected: 0 },
  { title: 'A scan, by extent, no viewer', x: extent, y: 'us', points: kernel('UnseenScanByExtent'), expected: 0 },
  {
    title: 'Memory, by explored area',
    x: 'square metres, cells of 0.05 m',
    y: 'MB',
    points: memory((of) => of.bytes / 1e6),
    expected: 1,
  },
  {
    title: 'Recovery without a checkpoint',
    x: 'scans in the log, in memory',
    y: 'ms',
    points: kernel('RecoveryByLogLength', 'real_time'),
    expected: 1,
  },
  {
    title: 'Recovery from a store on disk',
    x: 'scans in the log',
    y: 'ms',
    points: kernel('RecoveryFromDisk', 'real_time'),
    expected: 1,
  },
  {
    title: 'A scan, by sessions',
    x: 'sessions, a robot each',
    y: 'us of the server',
    points: await service(kMany, (n) => ({ robots: n })),
    expected: 0,
  },
  {
    title: 'A scan, by robots of a session',
    x: 'robots in one session',
    y: 'us of the server',
    points: await service(kRobots, (n) => ({ robots: n, sessions: 1 })),
    expected: 0,
  },
  {
    title: 'The server, by viewers',
    x: 'viewers of 16 sessions',
    y: 'us of the server a scan',
    points: await service(kViewers, (n) => ({ robots: 16, viewers: n })),
    expected: 1,
  },
];
const bytesPerCell = memory((of) => of.bytes_per_touched_cell);
const recovered = ['RecoveryByLogLength', 'RecoveryFromDisk'].map((name) => kernel(name, 'items_per_second'));
const idle = [await besideIdle(0), await besideIdle(kIdleSessions)];
writeFileSync(
  file,
  `${JSON.stringify({ machine: on, charts, bytes_per_touched_cell: bytesPerCell, recovered_scans_per_second: recovered, idle }, null, 2)}\n`,
);
writeFileSync(drawing, drawCharts(charts));
printTables();

function measureKernels() {
  const run = JSON.parse(
    execFileSync(program, [`--benchmark_min_time=${fullOrQuick(0.5, 0.02)}`, '--benchmark_format=json'], {
      encoding: 'utf8',
      stdio: ['ignore', 'pipe', 'ignore'],
      maxBuffer: 2 ** 26,
    }),
  );
  return run.benchmarks;
}

function kernel(name, figure = 'cpu_time') {
  return kernels
    .filter((benchmark) => benchmark.name.startsWith(`${name}/`))
    .map((benchmark) => [Number(benchmark.name.split('/')[1]), benchmark[figure]]);
}

function memory(figure) {
  return kernels
    .filter((benchmark) => benchmark.name.startsWith('MemoryByArea/'))
    .map((benchmark) => [Math.round(benchmark.square_metres), figure(benchmark)]);
}

/** Server CPU per scan, for runs that send the same number of scans per second. */
async function service(counts, optionsOf) {
  const points = [];
  for (const count of counts) {
    const server = await startServer();
    points.push([count, await costOfAScan(server, optionsOf(count))]);
    await server.stop();
  }
  return points;
}

async function costOfAScan(server, options) {
  const run = await load(server, {
    ...kRoom,
    duration: kSeconds,
    batch: 10,
    rate: kScansPerSecond / options.robots,
    ...options,
  });
  return run.server.cpu_us_per_scan;
}

/** The cost of a scan of a few sessions while other sessions are idle, and the memory of each idle session. */
async function besideIdle(sessions) {
  const server = await startServer();
  await costOfAScan(server, { robots: kBusySessions }); // so that memory shared by all sessions is allocated before
  const before = memoryBytes(server.child.pid);
  if (sessions > 0) await load(server, { ...kRoom, robots: sessions, rate: 1, duration: 2, seed: 2, keep: true });
  await untilQuiet(server);
  const bytes = memoryBytes(server.child.pid) - before;
  const us = [];
  for (let run = 0; run < kIdleRuns; ++run) us.push(await costOfAScan(server, { robots: kBusySessions }));
  await server.stop();
  return {
    sessions,
    us: us.sort((a, b) => a - b)[Math.floor(kIdleRuns / 2)],
    bytes_per_session: sessions > 0 ? bytes / sessions : 0,
  };
}

/**
 * Waits until the server is idle, checkpoints of sessions that have just become idle included. No event reports this;
 * the CPU time of a second does.
 */
async function untilQuiet(server) {
  for (let seconds = 0; seconds < kQuietSecondsMax; ++seconds) {
    const before = processorSeconds(server.child.pid);
    await new Promise((resolve) => setTimeout(resolve, 1000));
    if (processorSeconds(server.child.pid) - before < kQuietCores) return;
  }
}

function printTables() {
  console.log(describe(on), '\n');
  for (const { title, x, y, points } of charts) printPoints(title, x, y, points);
  printPoints(
    'Memory of a map: all its data, as counted by the allocator',
    'square metres',
    'bytes a touched cell',
    bytesPerCell,
  );
  printPoints('Recovery without a checkpoint', 'scans in the log', 'scans/s, log in memory', recovered[0]);
  printPoints('Recovery from a store on disk, files cached by the system', 'scans in the log', 'scans/s', recovered[1]);
  printPoints(
    `A scan of ${kBusySessions} sessions next to idle ones`,
    'idle sessions',
    'us of the server',
    idle.map(({ sessions, us }) => [sessions, us]),
  );
  console.log(
    `Server memory of each idle session, two scans in it: ${(idle[1].bytes_per_session / 1024).toFixed(0)} KiB`,
  );
  console.log(`written to ${file} and ${drawing}`);
}

function printPoints(title, x, y, points) {
  console.log(
    `${title}\n${table([x, ...points.map(([px]) => px)], [[y, ...points.map(([, py]) => threeDigits(py))]])}\n`,
  );
}
