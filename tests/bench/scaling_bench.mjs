/**
 * How cost grows with what there is: cells, beams, the map's extent, sessions, robots of one session, viewers; memory with
 * explored area, recovery with the log's length. Measured, told and drawn; a straight line beside the dashed one is as it
 * should be.
 *
 *   SCANLOOM_BIN_DIR=build/bin node tests/bench/scaling_bench.mjs build/bench/scaling_bench build/bench/scaling.json build/bench/scaling.svg
 */
import { execFileSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { Server } from '../e2e/programs.mjs';
import { load } from './load_runs.mjs';
import { drawCharts } from './report/chart.mjs';
import { inWords, machine } from './report/machine.mjs';
import { table, threeDigits } from './report/table.mjs';

/** Scans a second of all robots together, however many. */
const kScansPerSecond = 2000;
const kSeconds = 6;

const [program, file, drawing] = process.argv.slice(2);
const on = machine();
const kernels = measureKernels();
const charts = [
  { title: 'A scan, by cells', x: 'cells a metre', y: 'us', points: kernel('ScanByCellSize').map(([mm, us]) => [1000 / mm, us]), expected: 2 },
  { title: 'A scan, by beams', x: 'beams', y: 'us', points: kernel('ScanByBeams'), expected: 1 },
  { title: 'A scan, by extent of the map', x: 'rooms of 100 square metres', y: 'us', points: kernel('ScanByExtent'), expected: 0 },
  { title: 'Memory, by explored area', x: 'square metres, cells of 0.05 m', y: 'MB', points: memory(), expected: 1 },
  { title: 'Recovery without a checkpoint', x: 'scans in the log', y: 'ms', points: kernel('RecoveryByLogLength'), expected: 1 },
  { title: 'A scan, by sessions', x: 'sessions, a robot each', y: 'us of the server', points: await service([4, 16, 64, 256, 1024], (n) => ({ robots: n })), expected: 0 },
  { title: 'A scan, by robots of a session', x: 'robots in one session', y: 'us of the server', points: await service([4, 16, 64, 256], (n) => ({ robots: n, sessions: 1, verify: 'counts' })), expected: 0 },
  { title: 'The server, by viewers', x: 'viewers of 16 sessions', y: 'us of the server a scan', points: await service([1, 16, 64, 256], (n) => ({ robots: 16, viewers: n })), expected: 1 },
];
writeFileSync(file, `${JSON.stringify({ machine: on, charts }, null, 2)}\n`);
writeFileSync(drawing, drawCharts(charts));
console.log(inWords(on), '\n');
for (const { title, x, y, points } of charts) console.log(`${title}\n${table([x, ...points.map(([px]) => px)], [[y, ...points.map(([, py]) => threeDigits(py))]])}\n`);
console.log(`written to ${file} and ${drawing}`);

function measureKernels() {
  const run = JSON.parse(execFileSync(program, ['--benchmark_format=json'], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'], maxBuffer: 2 ** 26 }));
  return run.benchmarks;
}

function kernel(name) {
  return kernels.filter((benchmark) => benchmark.name.startsWith(`${name}/`)).map((benchmark) => [Number(benchmark.name.split('/')[1]), benchmark.cpu_time]);
}

function memory() {
  return kernels.filter((benchmark) => benchmark.name.startsWith('MemoryByArea/')).map((benchmark) => [Math.round(benchmark.square_metres), benchmark.bytes / 1e6]);
}

/** Server CPU a scan, of runs that send as many scans a second whatever there is. */
async function service(counts, optionsOf) {
  const points = [];
  for (const count of counts) {
    const server = await Server.start();
    const options = optionsOf(count);
    const robots = options.robots;
    const batch = 10;
    const run = await load(server, { duration: kSeconds, world: 'room', 'cell-size': 0.05, batch, rate: kScansPerSecond / robots, verify: 'counts', ...options });
    await server.stop();
    points.push([count, run.server.cpu_us_per_scan]);
  }
  return points;
}
