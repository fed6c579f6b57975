/**
 * The cost of a robot's program: CPU time, memory and bytes on the wire, while it reads an LD06 in real time.
 *
 *   SCANLOOM_WEB_DIR=build/web SCANLOOM_BIN_DIR=build/bin node tests/bench/robot_bench.mjs CAPTURE [--quick]
 *
 * CAPTURE contains bytes of a real LD06. They are sent over TCP, 375 packets of 47 bytes per second.
 */
import { mkdtemp, readFile, rm } from 'node:fs/promises';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { start, stop } from '../e2e/programs.mjs';
import { startServer } from './load_runs.mjs';
import { announce, fullOrQuick, operands } from './report/arguments.mjs';
import { memoryBytes, processorSeconds } from './report/process_use.mjs';

const kBytesPerSecond = (4500 / 12) * 47;
const kTickMs = 20;
const kWarmUpMs = 4000; // not measured: startup, connecting
const kMeasuredMs = fullOrQuick(15000, 3000);

const capture = await readFile(operands[0] ?? missing());
announce('robot', '100 seconds', '40 seconds');
const place = await mkdtemp(join(tmpdir(), 'scanloom-robot-bench-'));
const server = await startServer();
console.log(['', 'of one core', 'memory, most', 'bytes a scan'].map((title) => title.padStart(18)).join(''));
await measure('plain', []);
await measure('zstd', ['--compression', 'zstd']);
await measure('zstd, 1 s batches', ['--compression', 'zstd', '--batch-delay', '1']);
await measure('spool', ['--spool', join(place, 'spool')]);
await measure('spool, no server', ['--spool', join(place, 'spool')], 1);
await server.stop();
await rm(place, { recursive: true });

function missing() {
  console.error('usage: robot_bench.mjs CAPTURE');
  process.exit(2);
}

/** Runs the robot with these options, and prints one line. */
async function measure(name, options, port = server.robotPort) {
  const lidar = await startLidar();
  const session = name.replace(/[^a-z0-9]+/g, '-');
  const robot = start('scanloom-robot', [
    ...['--server', `127.0.0.1:${port}`, '--session', session, '--robot', 'r', ...options],
    ...['ld06', `tcp://127.0.0.1:${lidar.address().port}`, '--pose', '0,0,0'],
  ]);
  const printed = textOf(robot.stdout);
  await milliseconds(kWarmUpMs);
  const before = processorSeconds(robot.pid);
  await milliseconds(kMeasuredMs);
  const share = (processorSeconds(robot.pid) - before) / (kMeasuredMs / 1000);
  const memory = memoryBytes(robot.pid, 'VmHWM') / 2 ** 20;
  await stop(robot);
  lidar.close();
  const summary = JSON.parse(await printed);
  const bytes = summary.sent > 0 ? (summary.bytes / summary.sent).toFixed(0) : '-';
  const line = [name, `${(100 * share).toFixed(2)} %`, `${memory.toFixed(1)} MiB`, bytes];
  console.log(line.map((text) => text.padStart(18)).join(''));
}

/** Sends the capture to each client, at the rate of the sensor. */
async function startLidar() {
  const lidar = createServer((socket) => {
    const begun = performance.now();
    let sent = 0;
    const timer = setInterval(() => {
      const due = Math.min(capture.length, Math.floor(((performance.now() - begun) / 1000) * kBytesPerSecond));
      if (due > sent) socket.write(capture.subarray(sent, due));
      sent = Math.max(sent, due);
    }, kTickMs);
    socket.on('error', () => {});
    socket.on('close', () => clearInterval(timer));
  });
  await new Promise((resolve) => lidar.listen(0, '127.0.0.1', resolve));
  return lidar;
}

async function textOf(stream) {
  let text = '';
  for await (const part of stream) text += part;
  return text;
}

function milliseconds(count) {
  return new Promise((resolve) => setTimeout(resolve, count));
}
