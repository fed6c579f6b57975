/**
 * How fast tiles are served: those that are kept beside nginx with the very same bytes in a file, those that are known
 * already, and those that are drawn for the first time.
 *
 *   SCANLOOM_BIN_DIR=build/bin node tests/bench/tiles_bench.mjs RESULT.json [LOG]
 *
 * wrk asks all of them in turn, round after round, over 64 connections that stay; figures are medians of the rounds.
 * LOG is a recorded CARMEN log; without it a robot drives through a simulated office. Where nginx is missing, the server
 * is measured alone.
 */
import { execFile, spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { chmod, mkdir, mkdtemp, rm, writeFile } from 'node:fs/promises';
import { createServer } from 'node:net';
import { cpus, tmpdir } from 'node:os';
import { join } from 'node:path';
import { promisify } from 'node:util';
import { ended, Server, startRobot, stop } from '../e2e/programs.mjs';

const kConnections = 64;
const kRounds = 7;
const kSeconds = 3;
const kScans = 1500;
const kLayers = ['occupancy', 'himm', 'classification'];
const kRatioAim = 0.7;
const kFirstMsAim = 1;

const [result, log] = process.argv.slice(2);
if (!result) fail('name the file for the result: tiles_bench.mjs RESULT.json [LOG]');
const nginx = findProgram('nginx');
const wrk = findProgram('wrk') ?? fail("wrk is missing; install Debian's wrk: ./scanloom install bench");
if (!nginx) console.log("nginx is missing: the server is measured alone (./scanloom install bench)");

const server = await Server.start();
await makeMap();
const first = await drawAllTiles();
const tile = first.largest;
const place = await mkdtemp(join(tmpdir(), 'scanloom-tiles-bench-'));
const rivals = nginx ? [await startNginx(1), await startNginx(cpus().length)] : [];
const asked = [
  { name: 'scanloom', address: tile.address, headers: [] },
  ...rivals.map(({ name, address }) => ({ name, address, headers: [] })),
  { name: 'scanloom, 304', address: tile.address, headers: ['-H', `If-None-Match: ${tile.etag}`] },
];
const rates = await measure();
for (const rival of rivals) await stop(rival.child);
await server.stop();
await rm(place, { recursive: true });
await tell();

/** A map of the recorded log, or of a simulated office. */
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

/** Asks for each tile once. @returns what that took the server on average, and the tile with the most bytes */
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
  const tiles = after.count - before.count - changes - 1; // the second look at the times itself is counted later
  return { tiles, ms: ((after.seconds - before.seconds) * 1000) / tiles, largest };
}

/** What the server counts of all requests so far, this one but for its end. */
async function timeOfRequests() {
  const text = await (await fetch(`${server.address}metrics`)).text();
  const number = (what) => Number(text.match(new RegExp(`^scanloom_http_request_seconds_${what} (.*)$`, 'm'))[1]);
  return { seconds: number('sum'), count: number('count') };
}

/** nginx as one would run it for files that do not change. */
async function startNginx(workers) {
  const port = await freePort();
  const root = join(place, `root-${workers}`);
  await mkdir(root);
  await writeFile(join(root, 'tile.png'), tile.bytes);
  for (const directory of [place, root]) await chmod(directory, 0o755); // its workers may be another user
  const configuration = join(place, `nginx-${workers}.conf`);
  await writeFile(configuration, `
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
    }`);
  const child = spawn(nginx, ['-e', 'stderr', '-c', configuration], { stdio: ['ignore', 'ignore', 'inherit'] });
  const address = `http://127.0.0.1:${port}/tile.png`;
  for (let tries = 0; ; ++tries) {
    const answer = await fetch(address).catch(() => null);
    if (answer?.status === 200) break;
    if (child.exitCode !== null || tries > 100) fail(`nginx does not serve ${address}: ${answer?.status ?? 'it ended'}`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  return { name: `nginx, ${workers} worker${workers === 1 ? '' : 's'}`, address, child };
}

function freePort() {
  return new Promise((resolve) => {
    const listener = createServer().listen(0, '127.0.0.1', () => {
      const { port } = listener.address();
      listener.close(() => resolve(port));
    });
  });
}

/** @returns of each name the requests a second of every round */
async function measure() {
  const found = new Map(asked.map(({ name }) => [name, []]));
  for (let round = 0; round < kRounds; ++round) {
    for (const { name, address, headers } of asked) {
      const args = ['-t1', `-c${kConnections}`, `-d${kSeconds}s`, ...headers, address];
      const { stdout } = await promisify(execFile)(wrk, args);
      if (/Non-2xx or 3xx|Socket errors/.test(stdout)) fail(`${name} did not answer all requests: ${stdout}`);
      found.get(name).push(Number(stdout.match(/Requests\/sec: *([0-9.]+)/)[1]));
    }
  }
  return found;
}

/** Prints a table, and writes the same for programs. */
async function tell() {
  const own = rates.get('scanloom');
  // Round by round: what else the machine does then slows both.
  const ratios = rivals.map(({ name }) => ({ name, ratio: median(own.map((rate, n) => rate / rates.get(name)[n])) }));
  line('a tile of', `${tile.bytes.length} bytes`);
  for (const [name, each] of rates) line(name, `${median(each).toFixed(0)}/s`, `of ${kRounds} rounds, ${Math.min(...each).toFixed(0)} to ${Math.max(...each).toFixed(0)}`);
  for (const { name, ratio } of ratios) line(`of ${name}`, ratio.toFixed(2), verdict(ratio >= kRatioAim, `at least ${kRatioAim}`));
  line('first time, mean', `${first.ms.toFixed(2)} ms`, `${verdict(first.ms < kFirstMsAim, `below ${kFirstMsAim} ms`)}, ${first.tiles} tiles of all zooms, codes and PNG`);
  await writeFile(result, `${JSON.stringify({
    tile_bytes: tile.bytes.length,
    connections: kConnections,
    requests_per_second: Object.fromEntries([...rates].map(([name, each]) => [name, { median: median(each), rounds: each }])),
    ratios: Object.fromEntries(ratios.map(({ name, ratio }) => [name, ratio])),
    ratio_aim: kRatioAim,
    first_ms: first.ms,
    first_tiles: first.tiles,
    first_ms_aim: kFirstMsAim,
  }, null, 2)}\n`);
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
