/**
 * Tile throughput: cached tiles compared with nginx serving the same bytes from a file, tiles answered with 304, and
 * tiles that are drawn for the first time.
 *
 *   SCANLOOM_BIN_DIR=build/bin node tests/bench/tiles_bench.mjs RESULT.json [LOG] [--quick]
 *
 * wrk requests them in turn, round after round, over 64 keep-alive connections; figures are medians of the rounds. wrk
 * shares the CPUs with the server and does most of the work: it limits the rates, therefore the CPU time per request of
 * the server, or of nginx, is printed, too.
 * LOG is a recorded CARMEN log; without it a robot drives through a simulated office. If nginx is missing, only the
 * server is measured.
 */
import { execFile, spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { chmod, mkdir, mkdtemp, rm, writeFile } from 'node:fs/promises';
import { createServer } from 'node:net';
import { cpus, tmpdir } from 'node:os';
import { join } from 'node:path';
import { promisify } from 'node:util';
import { ended, startRobot, stop } from '../e2e/programs.mjs';
import { startServer } from './load_runs.mjs';
import { announce, fullOrQuick, operands } from './report/arguments.mjs';
import { describe, machineWithStore } from './report/machine.mjs';
import { processorSeconds } from './report/process_use.mjs';
import { table, threeDigits } from './report/table.mjs';

const kConnections = 64;
const kRounds = fullOrQuick(7, 2);
const kSeconds = fullOrQuick(3, 1);
const kScans = fullOrQuick(1500, 300);
const kLayers = ['occupancy', 'himm', 'classification'];
const kRatioAim = 0.7;
const kFirstMsAim = 1;

const [result, log] = operands;
if (!result) fail('usage: tiles_bench.mjs RESULT.json [LOG]');
const nginx = findProgram('nginx');
const wrk = findProgram('wrk') ?? fail("wrk is missing; install Debian's wrk: ./scanloom install bench");
if (!nginx) console.log('nginx is missing: only the server is measured (./scanloom install bench)');

announce('tiles', '3 minutes', '20 seconds');
const on = machineWithStore();
const server = await startServer();
await makeMap();
const first = await drawAllTiles();
const tile = first.largest;
const place = await mkdtemp(join(tmpdir(), 'scanloom-tiles-bench-'));
const kept = { name: 'scanloom, a tile that is kept', pid: server.child.pid, address: tile.address, headers: [] };
const known = { ...kept, name: 'scanloom, 304', headers: ['-H', `If-None-Match: ${tile.etag}`] };
const rivals = nginx ? [await startNginx(1), await startNginx(cpus().length)] : [];
const rivalsKnown = rivals.map((rival) => ({
  ...rival,
  name: `${rival.name}, 304`,
  headers: ['-H', `If-None-Match: ${rival.etag}`],
}));
const candidates = [kept, ...rivals, known, ...rivalsKnown];
const rounds = await measure();
for (const rival of rivals) await stop(rival.child);
await server.stop();
await rm(place, { recursive: true });
await printTables();

/** Creates a map from the recorded log, or from a simulated office. */
async function makeMap() {
  const source = log
    ? ['replay', log]
    : ['simulate', '--world', 'office', '--drive', 'wall_follower', '--seed', '1', '--speed', '20'];
  const robot = startRobot(server, 'bench', 'r1', source);
  if (log) {
    if ((await ended(robot)) !== 0) fail(`${log} could not be replayed`);
    return;
  }
  while ((await scans()) < kScans) await new Promise((resolve) => setTimeout(resolve, 100));
  await stop(robot);
}

async function scans() {
  const answer = await fetch(`${server.address}api/v1/sessions/bench`);
  return answer.ok ? (await answer.json()).scans : 0;
}

/** Requests each tile once. @returns the server's mean time, and the tile with the most bytes */
async function drawAllTiles() {
  const before = await timeOfRequests();
  let largest = { bytes: Buffer.alloc(0) };
  let changes = 0;
  for (const layer of kLayers) {
    const session = `${server.address}api/v1/sessions/bench`;
    const { tiles } = await (await fetch(`${session}/changes?layer=${layer}`)).json();
    ++changes;
    for (const { z, x, y } of tiles) {
      const address = `${session}/tiles/${layer}/${z}/${x}/${y}.png`;
      const answer = await fetch(address);
      if (answer.status !== 200) fail(`${address} was answered with ${answer.status}`);
      const bytes = Buffer.from(await answer.arrayBuffer());
      if (bytes.length > largest.bytes.length) largest = { bytes, address, etag: answer.headers.get('etag') };
    }
  }
  const after = await timeOfRequests();
  const tiles = after.count - before.count - changes - 1; // a later count includes the second query of the times itself
  return { tiles, ms: ((after.seconds - before.seconds) * 1000) / tiles, largest };
}

/** The server's request counts so far; they include this request, except for its end. */
async function timeOfRequests() {
  const text = await (await fetch(`${server.address}metrics`)).text();
  const number = (what) => Number(text.match(new RegExp(`^scanloom_http_request_seconds_${what} (.*)$`, 'm'))[1]);
  return { seconds: number('sum'), count: number('count') };
}

/** nginx, configured as usual for files that do not change. */
async function startNginx(workers) {
  const port = await freePort();
  const root = join(place, `root-${workers}`);
  await mkdir(root);
  await writeFile(join(root, 'tile.png'), tile.bytes);
  for (const directory of [place, root]) await chmod(directory, 0o755); // its workers may run as another user
  const configuration = join(place, `nginx-${workers}.conf`);
  await writeFile(
    configuration,
    `
    worker_processes ${workers};
    daemon off;
    pid ${join(place, `pid-${workers}`)};
    error_log stderr crit;
    events { worker_connections 2048; }
    http {
      access_log off;
      sendfile on;
      tcp_nopush on;
      tcp_nodelay on;
      keepalive_timeout 60;
      keepalive_requests 1000000000;
      open_file_cache max=100;
      open_file_cache_valid 600s;
      types { image/png png; }
      server { listen 127.0.0.1:${port}; root ${root}; }
    }`,
  );
  const child = spawn(nginx, ['-e', 'stderr', '-c', configuration], { stdio: ['ignore', 'ignore', 'inherit'] });
  const address = `http://127.0.0.1:${port}/tile.png`;
  for (let tries = 0; ; ++tries) {
    const answer = await fetch(address).catch(() => null);
    if (answer?.status === 200) {
      return {
        name: `nginx, ${workers} worker${workers === 1 ? '' : 's'}`,
        pid: child.pid,
        address,
        headers: [],
        etag: answer.headers.get('etag'),
        child,
      };
    }
    if (child.exitCode !== null || tries > 100)
      fail(`nginx does not serve ${address}: ${answer?.status ?? 'it ended'}`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

function freePort() {
  return new Promise((resolve) => {
    const listener = createServer().listen(0, '127.0.0.1', () => {
      const { port } = listener.address();
      listener.close(() => resolve(port));
    });
  });
}

/** @returns for each name {rate: requests per second, us: CPU time per request}, for every round */
async function measure() {
  const found = new Map(candidates.map(({ name }) => [name, []]));
  for (let round = 0; round < kRounds; ++round) {
    for (const { name, pid, address, headers } of candidates) {
      const before = processorSeconds(pid);
      const args = ['-t1', `-c${kConnections}`, `-d${kSeconds}s`, ...headers, address];
      const { stdout } = await promisify(execFile)(wrk, args);
      const seconds = processorSeconds(pid) - before;
      if (/Non-2xx or 3xx|Socket errors/.test(stdout)) fail(`${name} did not answer all requests: ${stdout}`);
      const requests = Number(stdout.match(/(\d+) requests in/)[1]);
      found
        .get(name)
        .push({ rate: Number(stdout.match(/Requests\/sec: *([0-9.]+)/)[1]), us: (1e6 * seconds) / requests });
    }
  }
  return found;
}

/** Prints tables, and writes the values as JSON. */
async function printTables() {
  const figures = Object.fromEntries(
    [...rounds].map(([name, each]) => [
      name,
      {
        requests_per_second: median(each.map(({ rate }) => rate)),
        cpu_us: median(each.map(({ us }) => us)),
        rounds: each,
      },
    ]),
  );
  // Ratios per round: other load in a round slows both.
  const over = (one, other, figure) =>
    median(rounds.get(one.name).map((round, n) => round[figure] / rounds.get(other.name)[n][figure]));
  const ratios = rivals.map((rival, n) => ({
    name: rival.name,
    rate: over(kept, rival, 'rate'),
    us: over(kept, rival, 'us'),
    us_304: over(known, rivalsKnown[n], 'us'),
  }));
  console.log(describe(on), '\n');
  console.log(
    table(
      [`a tile of ${tile.bytes.length} bytes, medians of ${kRounds} rounds`, 'requests/s', 'CPU, us a request'],
      Object.entries(figures).map(([name, of]) => [name, of.requests_per_second.toFixed(0), threeDigits(of.cpu_us)]),
    ),
  );
  console.log();
  for (const { name, rate, us, us_304 } of ratios) {
    line(`of ${name}`, rate.toFixed(2), verdict(rate >= kRatioAim, `at least ${kRatioAim}`));
    line("CPU, times nginx's", us.toFixed(2), `${us_304.toFixed(2)} for a 304`);
  }
  line(
    'first time, mean',
    `${first.ms.toFixed(2)} ms`,
    `${verdict(first.ms < kFirstMsAim, `below ${kFirstMsAim} ms`)}, ${first.tiles} tiles of all zooms, codes and PNG`,
  );
  await writeFile(
    result,
    `${JSON.stringify(
      {
        machine: on,
        tile_bytes: tile.bytes.length,
        connections: kConnections,
        requests: figures,
        ratios: Object.fromEntries(ratios.map(({ name, ...of }) => [name, of])),
        ratio_aim: kRatioAim,
        first_ms: first.ms,
        first_tiles: first.tiles,
        first_ms_aim: kFirstMsAim,
      },
      null,
      2,
    )}\n`,
  );
  console.log(`written to ${result}`);
}

function line(name, value, remark = '') {
  console.log(`${name.padEnd(24)}${value.padStart(14)}  ${remark}`);
}

function verdict(reached, aim) {
  return `${reached ? 'reaches' : 'MISSES'} the aim: ${aim}`;
}

function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)];
}

function findProgram(name) {
  const directories = [...process.env.PATH.split(':'), '/usr/sbin'];
  return directories.map((directory) => join(directory, name)).find(existsSync);
}

function fail(why) {
  console.error(why);
  process.exit(1);
}
