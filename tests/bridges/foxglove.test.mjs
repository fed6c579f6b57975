// scanloom-robot foxglove with Foxglove's own server of the protocol, and a real scanloom-server.
import assert from 'node:assert/strict';
import { mkdtemp, readdir, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { endWithThisProgram, ended, Server, startRobot } from '../e2e/programs.mjs';
import { Bridge, Robot } from './bridge.mjs';
import { kEncodings, nanoseconds, reader, typeName } from './messages.mjs';

const kScans = 150;
let server;

before(async () => {
  endWithThisProgram();
  server = await Server.start();
});

after(() => server?.stop());

/** Starts the program under test. @returns what outcomeOf() does */
function startReading(session, bridge) {
  const source = ['foxglove', bridge.url, '--publish-tf', '--publish-map', '--http', server.address.slice(0, -1)];
  return outcomeOf(startRobot(server, session, 'r1', source));
}

/** @returns the program, with its summary and its exit code as promises */
function outcomeOf(child) {
  let output = '';
  child.stdout.on('data', (text) => {
    output += text;
  });
  const code = ended(child);
  const summary = code.then(() => JSON.parse(output));
  return { child, code, summary };
}

/** Waits until a condition holds. */
async function until(what, holds) {
  const patience = Date.now() + 60_000; // so that a failure does not stop the run of the tests
  while (!(await holds())) {
    if (Date.now() > patience) assert.fail(`still not: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}

/** @returns the size of the server's map, and its cells as an OccupancyGrid has them */
async function serversMap(session) {
  const path = `${server.address}api/v1/sessions/${session}`;
  const [yaml, pgm] = await Promise.all(
    ['map.yaml', 'map.pgm'].map(async (file) => Buffer.from(await (await fetch(`${path}/${file}`)).arrayBuffer())),
  );
  const image = pgm.toString('latin1').match(/^P5\n(?:#.*\n)*(\d+) (\d+)\n255\n/);
  const [width, height] = [Number(image[1]), Number(image[2])];
  const pixels = pgm.subarray(image[0].length);
  const codes = new Map([
    [254, 0],
    [0, 100],
    [205, -1],
  ]);
  const cells = [];
  for (let row = height - 1; row >= 0; --row) {
    for (const pixel of pixels.subarray(row * width, (row + 1) * width)) cells.push(codes.get(pixel));
  }
  const origin = yaml.toString().match(/origin: \[([-0-9.]+), ([-0-9.]+)/);
  return { width, height, cells, origin: [Number(origin[1]), Number(origin[2])] };
}

/** @returns whether the newest grid that was published is the server's map */
async function isServersMap(session, published, encoding) {
  const newest = published.filter(({ topic }) => topic === '/map').at(-1);
  if (!newest) return false;
  const { info, data } = reader('nav_msgs/OccupancyGrid', encoding)(newest.data);
  const map = await serversMap(session);
  const near = (a, b) => Math.abs(a - b) < 1e-6;
  return (
    [info.width, info.height].join() === [map.width, map.height].join() &&
    near(info.origin.position.x, map.origin[0]) &&
    near(info.origin.position.y, map.origin[1]) &&
    Buffer.compare(Buffer.from(data), Buffer.from(map.cells)) === 0
  );
}

/** Checks the transforms that were published: map -> odom, near identity, with rising stamps of the robot's clock. */
function checkTransforms(published, encoding) {
  const read = reader('tf2_msgs/TFMessage', encoding);
  let last = 0n;
  for (const { data, schemaName } of published) {
    assert.equal(schemaName, typeName('tf2_msgs/TFMessage', encoding));
    const [{ header, child_frame_id, transform }, ...more] = read(data).transforms;
    assert.equal(more.length, 0);
    assert.deepEqual([header.frame_id, child_frame_id], ['map', 'odom']);
    const stamp = nanoseconds(header.stamp);
    assert.ok(stamp > last, `${stamp} follows ${last}`);
    assert.ok(stamp > 1_000n * 1_000_000_000n && stamp < 10_000n * 1_000_000_000n, `${stamp} is of the robot's clock`);
    last = stamp;
    const { translation, rotation } = transform;
    assert.ok(Math.hypot(translation.x, translation.y) < 0.2, JSON.stringify(translation));
    assert.ok(Math.abs(rotation.z) < 0.05 && translation.z === 0, JSON.stringify(transform));
  }
}

const isOfScans = (file) => file.endsWith('.spool');

const storedScans = async (session) => {
  const answer = await fetch(`${server.address}api/v1/sessions/${session}`);
  return answer.ok ? (await answer.json()).scans : 0;
};

for (const encoding of kEncodings) {
  test(`a robot of ${encoding} is mapped, and gets map -> odom and the map back`, async () => {
    const session = `live_${encoding}`;
    const bridge = await Bridge.start(encoding);
    const robot = new Robot(encoding);
    const reading = startReading(session, bridge);
    await bridge.subscribedToAll();
    robot.sendStatic(bridge);
    robot.sendPose(bridge, 0);
    await robot.drive(bridge, 0, kScans);
    await until('all scans are stored', async () => (await storedScans(session)) === kScans);
    await until('the map is published', () => isServersMap(session, bridge.published, encoding));
    const transforms = () => bridge.published.filter(({ topic }) => topic === '/tf');
    await until('transforms are published', () => transforms().length > 30);
    checkTransforms(transforms(), encoding);
    assert.deepEqual(bridge.errors, []);
    reading.child.kill('SIGTERM');
    const summary = await reading.summary;
    assert.equal(await reading.code, 0);
    assert.equal(summary.scans, kScans);
    assert.deepEqual(summary.skipped, {});
    assert.equal(summary.remarks, undefined);
    await bridge.stop();
  });
}

test('a bridge that restarts, and topics that get other ids, lose nothing that was sent', async () => {
  const session = 'restarted';
  const third = kScans / 3;
  let bridge = await Bridge.start('ros1');
  const robot = new Robot('ros1');
  const reading = startReading(session, bridge);
  await bridge.subscribedToAll();
  robot.sendStatic(bridge);
  robot.sendPose(bridge, 0);
  await robot.drive(bridge, 0, third);
  await until('the robot is surveyed', async () => (await storedScans(session)) === third);

  bridge.advertiseAgain('/scan');
  bridge.advertiseAgain('/tf');
  await bridge.subscribedToAll();
  await robot.drive(bridge, third, third - 1);
  robot.sendScan(bridge, 2 * third - 1); // its second pose comes after the restart
  const port = await bridge.stop();

  bridge = await Bridge.start('ros1', port);
  await bridge.subscribedToAll();
  robot.sendStatic(bridge);
  robot.sendPose(bridge, 2 * third);
  await robot.drive(bridge, 2 * third, third);
  await until('all scans are stored', async () => (await storedScans(session)) === kScans);
  await until('transforms are published again', () => bridge.published.some(({ topic }) => topic === '/tf'));
  reading.child.kill('SIGTERM');
  const summary = await reading.summary;
  assert.equal(summary.scans, kScans);
  assert.deepEqual(summary.skipped, {});
  assert.equal(summary.remarks, 'connected to the bridge 2 times');
  await bridge.stop();
});

test('scans in the spool are sent while the bridge is away', async () => {
  const session = 'spooled';
  const spool = await mkdtemp(join(tmpdir(), 'scanloom-bridge-'));
  const bridge = await Bridge.start('ros1');
  const robot = new Robot('ros1');
  const source = ['--spool', spool, 'foxglove', bridge.url];
  const nowhere = { robotPort: 1 };
  const first = startRobot(nowhere, session, 'r1', source);
  await bridge.subscribedToAll();
  robot.sendStatic(bridge);
  robot.sendPose(bridge, 0);
  await robot.drive(bridge, 0, kScans);
  await until('scans are spooled', async () => (await readdir(`${spool}/${session}.r1`)).some(isOfScans));
  first.kill('SIGKILL');
  await ended(first);
  await bridge.stop();

  const second = outcomeOf(startRobot(server, session, 'r1', [...source, '--reopen-for', '0']));
  const { error, waiting, acknowledged } = await second.summary;
  assert.match(error, /is foxglove_bridge running there/);
  assert.equal(waiting, 0);
  assert.ok(acknowledged > 0);
  assert.equal(await storedScans(session), acknowledged);
  await rm(spool, { recursive: true });
});
