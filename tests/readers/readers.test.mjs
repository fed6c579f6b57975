// Other programs read the server's exports: programs of Debian, where they are installed, and of npm.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { check } from '@placemarkio/check-geojson';
import { ended, endWithThisProgram, Server, startRobot } from '../e2e/programs.mjs';

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

/** The Python that has Debian's packages. */
const kDebiansPython = '/usr/bin/python3';

let server;
let folder;

before(async () => {
  endWithThisProgram();
  folder = mkdtempSync(join(tmpdir(), 'scanloom-readers-'));
  server = await Server.start();
  assert.equal(await ended(startRobot(server, 'office', 'r1', kSimulation)), 0);
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
  const image = printed(t, 'gdal-bin', 'gdalinfo', '-mm', await file(`${kSession}/map.png`, 'map.png'));
  if (image === undefined) return;
  assert.match(image, /Driver: PNG/);
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
  const read = printed(t, 'pcl-tools', 'pcl_ply2pcd', points, join(folder, 'points.pcd'));
  if (read === undefined) return;
  const count = readFileSync(points, 'latin1').match(/element vertex ([1-9]\d\d+)/)[1];
  assert.match(read, new RegExp(`${count} points`));
});

test('MRPT reads a scan and an odometry of each line', async (t) => {
  const log = await file(`${kSession}/log?format=clf`, 'office.log');
  const read = printed(t, 'mrpt-apps', 'carmen2rawlog', '-i', log, '-o', join(folder, 'office.rawlog'), '-w');
  if (read === undefined) return;
  const scans = readFileSync(log, 'latin1').match(/^ROBOTLASER1 /gm).length;
  const objects = Math.max(...[...read.matchAll(/\((\d+) objects\)/g)].map((match) => Number(match[1])));
  assert.ok(scans > 100 && objects > 1.9 * scans && objects <= 2 * scans, `${objects} objects of ${scans} scans`);
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
