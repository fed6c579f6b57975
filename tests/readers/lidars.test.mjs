// MRPT's drivers of lidars judge the emulators that our own drivers are tested with: rawlog-grabber reads them, where it
// is installed.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { after, before, test } from 'node:test';
import { ended, endWithThisProgram, Server, start, startRobot, stop } from '../e2e/programs.mjs';

/** As emulated: step n of the Hokuyo is at 1000 + n mm, but step 100 is an error code and step 200 sees nothing. */
const kHokuyoSteps = 1081;
const kWithoutRange = [100, 200];

let folder;

before(() => {
  endWithThisProgram();
  folder = mkdtempSync(join(tmpdir(), 'scanloom-lidars-'));
});

after(() => rmSync(folder, { recursive: true, force: true }));

function isInstalled(t) {
  if (spawnSync('sh', ['-c', 'command -v rawlog-grabber']).status === 0) return true;
  t.skip("rawlog-grabber was not found; it is in Debian's package mrpt-apps");
  return false;
}

/** Starts an emulated lidar, which runs until the end of the test. @returns its address or device */
async function emulate(t, model, line) {
  const child = start('../tests/lidar_emulator', [model, line]);
  t.after(() => stop(child));
  return new Promise((resolve) => createInterface({ input: child.stdout }).once('line', resolve));
}

/** Lets a driver of MRPT read some scans. @returns the ranges of the last one, in metres, and whether MRPT uses them */
async function grabbed(name, settings) {
  const ini = join(folder, `${name}.ini`);
  const places = ['x', 'y', 'z', 'yaw', 'pitch', 'roll'].map((axis) => `pose_${axis} = 0`);
  writeFileSync(
    ini,
    [
      ...['[global]', `rawlog_prefix = ${join(folder, name)}`, 'use_sensoryframes = 0', 'GRABBER_PERIOD_MS = 100'],
      ...['[LASER]', 'process_rate = 90', 'sensorLabel = LASER', ...settings, ...places, ''],
    ].join('\n'),
  );
  const grabber = spawn('rawlog-grabber', [ini], { stdio: ['pipe', 'pipe', 'inherit'] });
  let saved = 0;
  for await (const line of createInterface({ input: grabber.stdout })) {
    if (/Saved [1-9]/.test(line) && ++saved === 5) grabber.stdin.end('\n'); // any key ends it
  }
  const log = readdirSync(folder).find((file) => file.startsWith(`${name}_`) && file.endsWith('.rawlog'));
  const exported = spawnSync('rawlog-edit', ['-i', log, '--export-2d-scans-txt', '-q'], { cwd: folder });
  assert.equal(exported.status, 0, `${exported.stdout}${exported.stderr}`);
  const lines = readFileSync(join(folder, log.replace('.rawlog', '_LASER.txt')), 'latin1')
    .trim()
    .split('\n');
  const [, ...values] = lines.at(-1).trim().split(/\s+/).map(Number);
  return {
    ranges: values.slice(0, values.length / 2),
    valid: values.slice(values.length / 2),
    scans: lines.length - 1,
  };
}

test('MRPT reads the emulated Hokuyo over TCP as scanloom-robot does', async (t) => {
  if (!isInstalled(t)) return;
  const lidar = await emulate(t, 'hokuyo', 'tcp');
  const port = lidar.split(':').at(-1);
  const { ranges, valid, scans } = await grabbed('hokuyo', [
    ...['driver = CHokuyoURG', 'IP_DIR = 127.0.0.1', `PORT_DIR = ${port}`],
  ]);
  assert.ok(scans >= 5, `${scans} scans`);
  assert.equal(ranges.length, kHokuyoSteps);
  for (let step = 0; step < kHokuyoSteps; ++step) {
    assert.equal(valid[step], kWithoutRange.includes(step) ? 0 : 1, `step ${step}`);
    if (valid[step]) assert.equal(ranges[step], (1000 + step) / 1000, `step ${step}`);
  }

  const server = await Server.start();
  t.after(() => server.stop());
  const robot = startRobot(server, 's', 'r1', ['lidar', 'hokuyo', lidar, '--pose', '0,0,0']);
  const session = `${server.address}api/v1/sessions/s`;
  let stored = 0;
  while (stored < 3) {
    const response = await fetch(session);
    if (response.status === 200) stored = (await response.json()).scans;
  }
  robot.kill('SIGINT');
  assert.equal(await ended(robot), 0);
  const log = await (await fetch(`${session}/log?format=clf`)).text();
  // ROBOTLASER1 type start_angle field_of_view resolution range_max accuracy remission count ranges
  const [, , start_angle, field, , , , , count, ...rest] = log.match(/^ROBOTLASER1 .*$/m)[0].split(' ');
  assert.equal(Number(count), kHokuyoSteps);
  assert.ok(Math.abs(Number(start_angle) + (Math.PI * 135) / 180) < 1e-4, start_angle);
  assert.ok(Math.abs(Number(field) - (Math.PI * 270) / 180) < 1e-2, field);
  for (let step = 0; step < kHokuyoSteps; ++step) {
    if (valid[step]) assert.ok(Math.abs(Number(rest[step]) - ranges[step]) < 1e-3, `step ${step}: ${rest[step]}`);
  }
});

for (const [model, what] of [
  ['rplidar-a1', 'express capsules'],
  ['rplidar-c1', 'single points'],
]) {
  test(`MRPT reads the emulated RPLIDAR with ${what} on a serial line`, async (t) => {
    if (!isInstalled(t)) return;
    const lidar = await emulate(t, model, 'serial');
    const { ranges, scans } = await grabbed(model, ['driver = CRoboPeakLidar', `COM_port_LIN = ${lidar}`]);
    // MRPT 2.5 puts a point of A degrees at index 64 / 45 * A, because its driver reads angles in another unit than its copy
    // of the maker's library gives them. The order of the points and their ranges are judged all the same: n degrees are at
    // 1000 + 10 n mm.
    const seen = ranges.filter((range) => range > 0);
    assert.ok(scans >= 5 && seen.length > 100, `${scans} scans, ${seen.length} ranges`);
    for (let i = 1; i < seen.length; ++i) assert.ok(seen[i] > seen[i - 1], `${seen[i - 1]}, then ${seen[i]}`);
    for (const range of seen) assert.ok(Math.abs(range * 100 - Math.round(range * 100)) < 1e-3, `${range} m`);
    assert.ok(!seen.includes(1.9), '90 degrees have no measurement');
  });
}
