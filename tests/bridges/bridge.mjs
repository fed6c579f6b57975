/** A robot with a laser in a room, and a bridge by Foxglove's own server of the protocol. */
import { once } from 'node:events';
import protocol from '@foxglove/ws-protocol';
import { WebSocketServer } from 'ws';
import { definition, time, typeName, writer } from './messages.mjs';

const kSubprotocols = ['foxglove.sdk.v1', 'foxglove.websocket.v1'];
const kTopics = { '/scan': 'sensor_msgs/LaserScan', '/tf': 'tf2_msgs/TFMessage', '/tf_static': 'tf2_msgs/TFMessage' };

/** A bridge. Its clients may publish. */
export class Bridge {
  static async start(encoding, port = 0) {
    const bridge = new Bridge(encoding);
    bridge.sockets = new WebSocketServer({
      host: '127.0.0.1',
      port,
      handleProtocols: (offered) => kSubprotocols.find((name) => offered.has(name)) ?? false,
    });
    bridge.sockets.on('connection', (socket) => bridge.server.handleConnection(socket, 'robot'));
    await once(bridge.sockets, 'listening');
    return bridge;
  }

  constructor(encoding) {
    this.encoding = encoding;
    this.server = new protocol.FoxgloveServer({
      name: 'judge',
      capabilities: ['clientPublish'],
      supportedEncodings: [encoding],
    });
    this.channels = {};
    this.published = [];
    this.errors = [];
    this.subscribed = new Set();
    this.server.on('error', (error) => this.errors.push(error));
    this.server.on('message', ({ channel, data }) => {
      // the data is a part of a larger buffer
      this.published.push({ ...channel, data: new Uint8Array(data.buffer.slice(data.byteOffset)) });
    });
    this.server.on('subscribe', (id) => this.subscribed.add(id));
    for (const [topic, type] of Object.entries(kTopics)) this.advertise(topic, type);
  }

  get url() {
    return `ws://127.0.0.1:${this.sockets.address().port}`;
  }

  advertise(topic, type) {
    this.channels[topic] = this.server.addChannel({
      topic,
      encoding: this.encoding,
      schemaName: typeName(type, this.encoding),
      schema: definition(type, this.encoding),
    });
  }

  /** Takes a topic away, and offers it again under another id. */
  advertiseAgain(topic) {
    this.server.removeChannel(this.channels[topic]);
    this.advertise(topic, kTopics[topic]);
  }

  /** Waits until a client has subscribed to all topics. */
  async subscribedToAll() {
    while (!Object.values(this.channels).every((id) => this.subscribed.has(id))) {
      await new Promise((resolve) => this.server.on('subscribe', () => setImmediate(resolve)));
    }
  }

  send(topic, logTime, bytes) {
    this.server.sendMessage(this.channels[topic], BigInt(logTime), bytes);
  }

  /** Ends the bridge, after what it has sent. */
  async stop() {
    const port = this.sockets.address().port;
    for (const socket of this.sockets.clients) socket.close(1001);
    this.sockets.close();
    await once(this.sockets, 'close');
    return port;
  }
}

const kBeams = 360;
const kRangeMax = 12;
const kPeriod = 100_000_000; // ns
const kBegin = 1_000_000_000_000; // ns: a simulation's clock
const kWalls = [
  ...outline(-4, -3, 4, 3),
  ...outline(1.5, 0.5, 2, 1.1), // a pillar
  ...outline(-2.2, -2.2, -1.7, -1.4),
];

/** @returns the sides of a rectangle */
function outline(left, bottom, right, top) {
  const corners = [
    [left, bottom],
    [right, bottom],
    [right, top],
    [left, top],
  ];
  return corners.map((corner, n) => [...corner, ...corners[(n + 1) % 4]]);
}

/** @returns the distance from a point to the nearest wall in a direction */
function distance(x, y, angle) {
  let nearest = Number.POSITIVE_INFINITY;
  const [dx, dy] = [Math.cos(angle), Math.sin(angle)];
  for (const [ax, ay, bx, by] of kWalls) {
    const [ex, ey] = [bx - ax, by - ay];
    const cross = dx * ey - dy * ex;
    if (cross === 0) continue;
    const along = ((ax - x) * ey - (ay - y) * ex) / cross;
    const share = ((ax - x) * dy - (ay - y) * dx) / cross;
    if (along > 0 && share >= 0 && share <= 1) nearest = Math.min(nearest, along);
  }
  return nearest;
}

/** A robot that drives a circle through the room; its odometry is exact. */
export class Robot {
  constructor(encoding) {
    this.encoding = encoding;
    this.scan = writer('sensor_msgs/LaserScan', encoding);
    this.transforms = writer('tf2_msgs/TFMessage', encoding);
  }

  header(stamp, frame_id) {
    return { seq: 0, stamp: time(stamp, this.encoding), frame_id };
  }

  transform(stamp, parent, child, [x, y, yaw]) {
    return this.transforms({
      transforms: [
        {
          header: this.header(stamp, parent),
          child_frame_id: child,
          transform: {
            translation: { x, y, z: 0 },
            rotation: { x: 0, y: 0, z: Math.sin(yaw / 2), w: Math.cos(yaw / 2) },
          },
        },
      ],
    });
  }

  /** @returns the pose after so many periods */
  pose(periods) {
    const angle = periods * 0.02;
    return [1.2 * Math.cos(angle) - 1.2, 1.2 * Math.sin(angle), angle + Math.PI / 2];
  }

  sendStatic(bridge) {
    bridge.send('/tf_static', kBegin, this.transform(kBegin, 'base_link', 'laser', [0.1, 0, 0]));
  }

  /** Sends the pose at a period. */
  sendPose(bridge, n) {
    const stamp = kBegin + n * kPeriod;
    bridge.send('/tf', stamp, this.transform(stamp, 'odom', 'base_link', this.pose(n)));
  }

  /** Sends the scan in the middle between two periods. */
  sendScan(bridge, n) {
    const stamp = kBegin + n * kPeriod + kPeriod / 2;
    const [x, y, yaw] = this.pose(n + 0.5);
    const increment = (2 * Math.PI) / kBeams;
    const [laserX, laserY] = [x + 0.1 * Math.cos(yaw), y + 0.1 * Math.sin(yaw)];
    const bytes = this.scan({
      header: this.header(stamp, 'laser'),
      angle_min: -Math.PI,
      angle_max: Math.PI - increment,
      angle_increment: increment,
      time_increment: 0,
      scan_time: 0.1,
      range_min: 0.1,
      range_max: kRangeMax,
      ranges: Array.from({ length: kBeams }, (_, k) => distance(laserX, laserY, yaw - Math.PI + k * increment)),
      intensities: [],
    });
    bridge.send('/scan', stamp, bytes);
  }

  /** Sends scans from number `first` on, each between its two poses. */
  async drive(bridge, first, count) {
    for (let n = first; n < first + count; ++n) {
      this.sendScan(bridge, n);
      this.sendPose(bridge, n + 1);
      await new Promise(setImmediate); // as a robot's messages, they come one after another
    }
  }
}
