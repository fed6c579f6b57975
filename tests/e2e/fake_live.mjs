/** The live connections of a fake server: WebSockets (RFC 6455) that send the test's changes of a session. */
import { createHash } from 'node:crypto';
import { liveProtocol } from '../../web/protocol.js';
import { PbfReader, PbfWriter } from '../../web/node_modules/pbf/index.js';

const { readLiveRequest, writeLiveEvent, Layer } = await import(
  `data:text/javascript,${encodeURIComponent(liveProtocol())}`
);

const kGuid = '258EAFA5-E914-47DA-95CA-C5AB0DC85B11';
const kNativeZoom = 9;
const kStateOk = 1;
const kStateFailed = 2;

/** One viewer of a session. */
export class FakeLive {
  constructor(socket, session) {
    Object.assign(this, { socket, session });
    this.sent = 0;
    /** Revision up to which landmarks were sent; null: not subscribed. */
    this.sentLandmarks = null;
    this.unread = Buffer.alloc(0);
    /** Sends nothing more and does not close the connection, as a router does that dropped it. */
    this.isMute = false;
  }

  /** Answers the upgrade, and sends the whole state. */
  static accept(request, socket, session) {
    const key = createHash('sha1')
      .update(request.headers['sec-websocket-key'] + kGuid)
      .digest('base64');
    socket.write(
      'HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n' +
        `Sec-WebSocket-Accept: ${key}\r\n\r\n`,
    );
    socket.on('error', () => {});
    const live = new FakeLive(socket, session);
    session.viewers.add(live);
    socket.on('close', () => session.viewers.delete(live));
    socket.on('data', (bytes) => live.receive(bytes));
    live.notify();
    return live;
  }

  /** Reads the browser's masked frames. Only the landmarks subscription matters here. */
  receive(bytes) {
    this.unread = Buffer.concat([this.unread, bytes]);
    for (;;) {
      const length = this.unread[1] & 0x7f;
      const end = 6 + length;
      // Requests have a few bytes; a longer frame is not a request.
      if (this.unread.length < 6 || length > 125 || this.unread.length < end) return;
      const mask = this.unread.subarray(2, 6);
      const body = this.unread.subarray(6, end).map((byte, at) => byte ^ mask[at % 4]);
      const isRequest = this.unread[0] === 0x82;
      this.unread = this.unread.subarray(end);
      if (isRequest) this.obey(readLiveRequest(new PbfReader(body)));
    }
  }

  obey({ landmarks }) {
    this.session.subscriptions.push({ landmarks });
    this.sentLandmarks = landmarks ? (this.sentLandmarks ?? 0) : null;
    if (landmarks) this.notify();
  }

  /** Sends the changes since the last event. */
  notify() {
    if (this.isMute) return;
    const writer = new PbfWriter();
    writeLiveEvent(this.session.liveEvent(this.sent, this.sentLandmarks), writer);
    this.sent = this.session.revision;
    if (this.sentLandmarks !== null) this.sentLandmarks = this.session.revision;
    this.socket.write(frame(0x82, Buffer.from(writer.finish())));
  }

  /** Sends bytes that are no event. */
  sendNonsense(bytes) {
    this.socket.write(frame(0x82, Buffer.from(bytes)));
  }

  close(code, reason) {
    const body = Buffer.alloc(2 + Buffer.byteLength(reason));
    body.writeUInt16BE(code, 0);
    body.write(reason, 2);
    this.socket.end(frame(0x88, body));
  }
}

/** Returns a session's changes as a message. */
export function eventOf(session, since, landmarksSince) {
  const tiles = [];
  const revisions = [];
  for (const [key, { revision }] of session.tiles) {
    const [z, x, y] = key.split('/').map(Number);
    if (z !== kNativeZoom || revision <= since) continue;
    tiles.push(512 * y + x);
    revisions.push(revision);
  }
  return {
    session: session.id,
    revision: session.revision,
    state: session.failure ? kStateFailed : kStateOk,
    reason: session.failure ?? '',
    counters: { scans: session.scans, robots: session.robots.length, connected: session.robots.length, chunks: 1 },
    frontiers_revision: session.revision,
    goals_revision: session.goalsRevision,
    tiles: session.layers.map((layer) => ({ layer: Layer[`LAYER_${layer.toUpperCase()}`], tiles, revisions })),
    robots: session.robots.map((robot, index) => robotNews(session, robot, index, since)),
    landmarks: landmarksSince === null ? undefined : landmarkNews(session, landmarksSince),
    moving_scans: session.movingScans,
  };
}

function landmarkNews({ landmarks, noLandmarks, revision }, since) {
  const news = landmarks.filter(({ last }) => last > since);
  return { landmarks: news, following: 0, captures: 1, revision, refused: noLandmarks ?? '' };
}

function robotNews(session, robot, index, since) {
  const track = session.tracks.get(robot.name) ?? [];
  const points = track.filter(({ revision }) => revision > since).map(({ point }) => point);
  return {
    robot: index,
    name: robot.name,
    connected: robot.connected,
    pose: robot.pose,
    scan_count: robot.scans,
    last_seq: robot.last_seq,
    trail: differences(points, 0, 0),
    trail_from: track.length - points.length,
    scan: session.scan && {
      kind: 1,
      origin: robot.pose,
      points: differences(session.scan, robot.pose.x, robot.pose.y),
    },
    body_radius: robot.body_radius ?? 0,
    localization: robot.known,
  };
}

/** Converts to whole millimetres. */
function differences(points, x, y) {
  let last = [0, 0];
  return points.flatMap(([px, py]) => {
    const at = [Math.round((px - x) * 1000), Math.round((py - y) * 1000)];
    const step = [at[0] - last[0], at[1] - last[1]];
    last = at;
    return step;
  });
}

/** Returns one unmasked frame. */
function frame(first, body) {
  const length = body.length;
  const head = length < 126 ? Buffer.from([first, length]) : Buffer.alloc(length < 65536 ? 4 : 10);
  if (length >= 126) head[0] = first;
  if (length >= 65536) {
    head[1] = 127;
    head.writeBigUInt64BE(BigInt(length), 2);
  } else if (length >= 126) {
    head[1] = 126;
    head.writeUInt16BE(length, 2);
  }
  return Buffer.concat([head, body]);
}
