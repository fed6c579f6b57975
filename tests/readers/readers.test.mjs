// Other programs read the server's exports: programs of Debian, where they are installed, and of npm.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import rosmsg from '@foxglove/rosmsg';
import rosmsg2 from '@foxglove/rosmsg2-serialization';
import foxglove from '@foxglove/ws-protocol';
import { McapIndexedReader } from '@mcap/core';
import { loadDecompressHandlers } from '@mcap/support';
import { check } from '@placemarkio/check-geojson';
import WebSocket from 'ws';
import { ended, endWithThisProgram, Server, startRobot } from '../e2e/programs.mjs';

const { FoxgloveClient } = foxglove;
const kSession = 'api/v1/sessions/office';
const kSimulation = [
  'simulate',
  '--world',
  'office',
  '--drive',
  'wall_follower',
  '--seed',
  '1',
  '--speed',
  '0',
  '--duration',
  '60',
];

/**
 * Watches a session with Foxglove's own client until each topic has a message.
 *
 * @returns the newest message of each topic, decoded if it is of ROS
 */
async function watched(session, topics) {
  const address = `${server.address.replace('http', 'ws')}api/v1/sessions/${session}/foxglove`;
  const client = new FoxgloveClient({ ws: new WebSocket(address, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
  const subscribed = new Map();
  const newest = new Map();
  client.on('advertise', (channels) => {
    for (const channel of channels) subscribed.set(client.subscribe(channel.id), channel);
  });
  const problems = [];
  client.on('status', (status) => problems.push(status.message));
  await new Promise((resolve, reject) => {
    client.on('error', reject);
    client.on('close', (event) => reject(new Error(`closed: ${event.code} ${event.reason}`)));
    client.on('message', ({ subscriptionId, data }) => {
      const channel = subscribed.get(subscriptionId);
      newest.set(channel.topic, channel.encoding === 'cdr' ? decoded(channel.schema, data) : data);
      if (topics.every((topic) => newest.has(topic))) resolve();
    });
  });
  client.close();
  assert.deepEqual(problems, []);
  return newest;
}

/** Decodes a message of ROS 2. */
function decoded(definition, data) {
  return new rosmsg2.MessageReader(rosmsg.parse(definition, { ros2: true })).readMessage(data);
}

/** Asserts that an OccupancyGrid has the cells of map.pgm. */
async function assertIsMap(grid, session) {
  const pgm = readFileSync(await file(`api/v1/sessions/${session}/map.pgm`, `${session}.pgm`));
  const { width, height } = grid.info;
  const cells = [...grid.data].map((cell) => ({ '-1': 205, 0: 254, 100: 0 })[cell]);
  const rows = Array.from({ length: height }, (_, row) => cells.slice(row * width, (row + 1) * width));
  assert.deepEqual(rows.reverse().flat(), [...pgm.subarray(pgm.length - width * height)], 'an image begins at the top');
}

/** The Python that has Debian's packages. */
const kDebiansPython = '/usr/bin/python3';

let server;
let folder;

before(async () => {
  endWithThisProgram();
  folder = mkdtempSync(join(tmpdir(), 'scanloom-readers-'));
  server = await Server.start();
  assert.equal(await ended(startRobot(server, 'office', 'r1', kSimulation)), 0);
  assert.equal(await ended(startRobot(server, 'drift', 'r1', [...kSimulation, '--poses', 'odometry'])), 0);
});

after(async () => {
  await server?.stop();
  rmSync(folder, { recursive: true, force: true });
});

async function text(path) {
  const response = await fetch(`${server.address}${path}`);
  assert.equal(response.status, 200, path);
  return response.text();
}

/** Downloads to a file. @returns its path */
async function file(path, name) {
  const response = await fetch(`${server.address}${path}`);
  assert.equal(response.status, 200, path);
  const place = join(folder, name);
  writeFileSync(place, Buffer.from(await response.arrayBuffer()));
  return place;
}

/** @returns the program's output; undefined, and a skipped test, if it is not installed */
function printed(t, debianPackage, program, ...args) {
  const run = spawnSync(program, args, { encoding: 'utf8' });
  if (run.error?.code === 'ENOENT') {
    t.skip(`${program} was not found; it is in Debian's package ${debianPackage}`);
    return undefined;
  }
  assert.equal(run.status, 0, `${program} ${args.join(' ')}\n${run.stdout}${run.stderr}`);
  return run.stdout + run.stderr;
}

test('numpy reads maps as tables and as arrays, and both agree', async (t) => {
  const table = await file(`${kSession}/map.csv`, 'map.csv');
  const array = await file(`${kSession}/map.npy`, 'map.npy');
  const read = printed(
    ...[t, 'python3-numpy', kDebiansPython, '-c'],
    `
import sys
try:
    import numpy
except ImportError:
    sys.exit(print('no numpy'))
table, array = numpy.loadtxt(sys.argv[1], delimiter=','), numpy.load(sys.argv[2])
assert table.shape == array.shape and min(table.shape) > 100, (table.shape, array.shape)
known = table >= 0
assert (known == ~numpy.isnan(array)).all() if array.dtype.kind == 'f' else (known == (array >= 0)).all()
print('occupied', (table > 65).sum(), 'free', ((table >= 0) & (table < 35)).sum())
`,
    table,
    array,
  );
  if (read?.includes('no numpy')) return t.skip("numpy was not found; it is in Debian's package python3-numpy");
  assert.match(read, /occupied [1-9]\d+ free [1-9]\d\d/);
});

test('GDAL reads images and points', async (t) => {
  const world = readFileSync(await file(`${kSession}/map.pgw`, 'map.pgw'), 'latin1')
    .split('\n')
    .map(Number);
  const image = printed(t, 'gdal-bin', 'gdalinfo', '-mm', await file(`${kSession}/map.png`, 'map.png'));
  if (image === undefined) return;
  assert.match(image, /Driver: PNG/);
  const [size, , , , left, top] = world;
  const numbers = (label) =>
    image
      .match(new RegExp(`${label} = \\(([-0-9.]+),([-0-9.]+)\\)`))
      .slice(1)
      .map(Number);
  const near = (found, expected) => found.every((value, n) => Math.abs(value - expected[n]) < 1e-6);
  assert.ok(near(numbers('Pixel Size'), [size, -size]), image);
  assert.ok(near(numbers('Origin'), [left - size / 2, top + size / 2]), image);
  const points = await file(`${kSession}/points.csv`, 'points.csv');
  const options = ['-oo', 'X_POSSIBLE_NAMES=x', '-oo', 'Y_POSSIBLE_NAMES=y', '-oo', 'AUTODETECT_TYPE=YES'];
  const table = printed(t, 'gdal-bin', 'ogrinfo', '-so', '-al', ...options, points);
  assert.match(table, /Geometry: Point/);
  assert.match(table, /Feature Count: [1-9]\d\d+/);
  const paths = await file(`${kSession}/trajectory.geojson`, 'trajectory.geojson');
  assert.match(printed(t, 'gdal-bin', 'ogrinfo', '-so', '-al', paths), /Geometry: (3D )?Line String/);
});

test('PCL reads all points', async (t) => {
  const points = await file(`${kSession}/points.ply`, 'points.ply');
  const read = printed(t, 'pcl-tools', 'pcl_ply2pcd', points, join(folder, 'made.pcd'));
  if (read === undefined) return;
  const count = readFileSync(points, 'latin1').match(/element vertex ([1-9]\d\d+)/)[1];
  assert.match(read, new RegExp(`${count} points`));
  const cloud = await file(`${kSession}/points.pcd`, 'points.pcd');
  assert.match(printed(t, 'pcl-tools', 'pcl_pcd2ply', cloud, join(folder, 'made.ply')), new RegExp(`${count} points`));
});

test('MRPT optimises the pose graph, and moves no keyframe far', async (t) => {
  const graph = await file('api/v1/sessions/drift/pose_graph.g2o', 'drift.graph');
  const optimised = join(folder, 'optimised.graph');
  const options = ['--2d', '--levmarq', '--no-span', '-q', '-i', graph, '-o', optimised];
  if (printed(t, 'mrpt-apps', 'graph-slam', ...options) === undefined) return;
  const vertices = (path) =>
    new Map([...readFileSync(path, 'latin1').matchAll(/^VERTEX_SE2 (\d+) (\S+) (\S+)/gm)].map((at) => [at[1], at]));
  const before = vertices(graph);
  const after = vertices(optimised);
  assert.ok(before.size > 20, `${before.size} keyframes`);
  assert.deepEqual([...after.keys()], [...before.keys()]);
  for (const [id, [, , x, y]] of before) {
    const [, , toX, toY] = after.get(id);
    assert.ok(Math.hypot(toX - x, toY - y) < 0.05, `${id}: ${x}, ${y} to ${toX}, ${toY}`);
  }
});

test('MRPT reads a scan and an odometry of each line', async (t) => {
  const log = await file(`${kSession}/log?format=clf`, 'office.log');
  const read = printed(t, 'mrpt-apps', 'carmen2rawlog', '-i', log, '-o', join(folder, 'office.rawlog'), '-w');
  if (read === undefined) return;
  const scans = readFileSync(log, 'latin1').match(/^ROBOTLASER1 /gm).length;
  const objects = Math.max(...[...read.matchAll(/\((\d+) objects\)/g)].map((match) => Number(match[1])));
  assert.ok(scans > 100 && objects > 1.9 * scans && objects <= 2 * scans, `${objects} objects of ${scans} scans`);
});

test('the readers of Foxglove find scans, poses and the map in an MCAP file', async () => {
  const bytes = readFileSync(await file('api/v1/sessions/drift/log?format=mcap', 'drift.mcap'));
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => bytes.subarray(Number(offset), Number(offset + length)),
  };
  const decompressHandlers = await loadDecompressHandlers();
  const recording = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const messages = new Map();
  for await (const message of recording.readMessages({ validateCrcs: true })) {
    const channel = recording.channelsById.get(message.channelId);
    const definition = new TextDecoder().decode(recording.schemasById.get(channel.schemaId).data);
    if (!messages.has(channel.topic)) messages.set(channel.topic, []);
    messages.get(channel.topic).push(decoded(definition, message.data));
  }
  const trajectory = (await text('api/v1/sessions/drift/trajectory.tum')).match(/^[^#\n]+/gm);
  assert.deepEqual([...messages.keys()].sort(), ['/map', '/r1/pose', '/r1/scan', '/tf']);
  for (const topic of ['/r1/pose', '/r1/scan', '/tf']) assert.equal(messages.get(topic).length, trajectory.length);
  for (const [n, line] of trajectory.entries()) {
    const [, x, y] = line.split(' ').map(Number);
    for (const place of [
      messages.get('/r1/pose')[n].pose.position,
      messages.get('/tf')[n].transforms[0].transform.translation,
    ]) {
      assert.ok(Math.hypot(place.x - x, place.y - y) < 0.02, `${n}: ${place.x}, ${place.y} instead of ${x}, ${y}`);
    }
  }
  await assertIsMap(messages.get('/map')[0], 'drift');
});

test('the client of Foxglove shows the live map, robots and their ways', async () => {
  const topics = ['/map', '/tf', '/diagnostics', '/frontiers', '/goals', '/landmarks', '/pose_graph'];
  const newest = await watched('drift', [...topics, '/r1/pose', '/r1/trail', '/r1/path']);
  await assertIsMap(newest.get('/map'), 'drift');
  const [robot] = newest.get('/tf').transforms;
  assert.deepEqual([robot.header.frame_id, robot.child_frame_id], ['map', 'r1/base_link']);
  const trail = newest.get('/r1/trail').poses;
  assert.equal(trail.length, 600);
  assert.deepEqual(trail.at(-1).pose, newest.get('/r1/pose').pose);
  const [status] = newest.get('/diagnostics').status;
  assert.deepEqual([status.name, status.level], ['r1', 1]);
  assert.equal(status.message, 'tracking, not connected');
});

test('numpy reads a KITTI trajectory as matrices', async (t) => {
  const read = printed(
    ...[t, 'python3-numpy', kDebiansPython, '-c'],
    `
import sys
try:
    import numpy
except ImportError:
    sys.exit(print('no numpy'))
poses = numpy.loadtxt(sys.argv[1]).reshape(-1, 3, 4)
stamps = numpy.loadtxt(sys.argv[2])
assert len(poses) == len(stamps) > 100
assert numpy.allclose(numpy.linalg.det(poses[:, :, :3]), 1)
assert numpy.allclose(poses[:, :2, 3], stamps[:, 1:3], atol=1e-5)
print('equal')
`,
    await file(`${kSession}/trajectory.kitti`, 'office.kitti'),
    await file(`${kSession}/trajectory.tum`, 'office.tum'),
  );
  if (read?.includes('no numpy')) return t.skip("numpy was not found; it is in Debian's package python3-numpy");
  if (read !== undefined) assert.match(read, /equal/);
});

test('Prometheus reads metrics', async (t) => {
  const metrics = await text('metrics');
  const run = spawnSync('promtool', ['check', 'metrics'], { encoding: 'utf8', input: metrics });
  if (run.error?.code === 'ENOENT') return t.skip("promtool was not found; it is in Debian's package prometheus");
  assert.equal(run.status, 0, run.stdout + run.stderr);
});

for (const name of ['trajectory', 'frontiers', 'landmarks', 'goals']) {
  test(`${name}.geojson is GeoJSON`, async () => {
    assert.equal(check(await text(`${kSession}/${name}.geojson`)).type, 'FeatureCollection');
  });
}
