/**
 * A server whose answers the test decides, for states that a real server rarely has.
 * It implements the part of the HTTP API that the viewer reads, with the headers of the real server.
 */
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import { FakeLive } from './fake_live.mjs';
import { FakeSession } from './fake_session.mjs';
import { encodeGreyPng } from './png.mjs';

const kTileSize = 256;
const kMediaTypes = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript; charset=utf-8',
  '.css': 'text/css; charset=utf-8',
  '.svg': 'image/svg+xml',
};
const kSecurityHeaders = {
  'Content-Security-Policy':
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; connect-src 'self' ws:",
  'X-Content-Type-Options': 'nosniff',
};

/** Converts a layer's code to the tile's pixel: the bytes of .bin are the codes themselves. */
const kLevelOf = {
  occupancy: (percent) => Math.round(255 - 2.55 * percent),
  sonar: (percent) => Math.round(255 - 2.55 * percent),
  himm: (count) => 255 - 17 * count,
  // The red component of each class's colour, the only one that the viewer reads.
  classification: (code) => [128, 255, 67, 46, 217][code],
};
const kUntouched = { occupancy: 255, sonar: 255, himm: 255, classification: 0 };

/** Sessions by name; live connections of a removed session are closed. */
class Sessions extends Map {
  set(name, session) {
    if (this.get(name) !== session) this.get(name)?.end();
    return super.set(name, session);
  }

  delete(name) {
    this.get(name)?.end();
    return super.delete(name);
  }

  clear() {
    for (const session of this.values()) session.end();
    super.clear();
  }
}

export class FakeServer {
  sessions = new Sessions();
  /** Path of every API request, in order. */
  requests = [];
  /** Number of established live connections. */
  sockets = new Set();
  /** Path and query of every tile request, in order. */
  tileRequests = [];
  /** When set, {status, title, detail}: the answer to every API request. */
  failure = null;
  /** When set, the status of every tile. */
  tileFailure = null;
  /** When set, the answer to requests that create or delete a session. */
  refusal = null;
  /** The bodies of requests that created sessions, in order. */
  wanted = [];
  /** When set, a promise; requests that create or delete a session wait for it. */
  hold = null;
  /** The text of /metrics. */
  metrics = '';
  metricsRequests = 0;
  /** Sessions that cannot be served, {name, reason}. */
  damaged = [];
  /** Address for robots. */
  robots = { host: null, port: 17447 };

  static async start(webDirectory) {
    const fake = new FakeServer(webDirectory);
    await fake.listen(0);
    return fake;
  }

  constructor(webDirectory) {
    this.webDirectory = webDirectory;
  }

  get address() {
    return `http://127.0.0.1:${this.port}/`;
  }

  add(session) {
    this.sessions.set(session.name, session);
    return session;
  }

  async listen(port) {
    this.server = createServer((request, response) => void this.answer(request, response));
    this.server.on('upgrade', (request, socket) => this.upgrade(request, socket));
    await new Promise((resolve) => this.server.listen(port, '127.0.0.1', resolve));
    this.port = this.server.address().port;
  }

  /** Stops like a crashed process: accepts no more connections and breaks the open ones. */
  async vanish() {
    const closed = new Promise((resolve) => this.server.close(resolve));
    this.server.closeAllConnections();
    for (const socket of this.sockets) socket.destroy();
    await closed;
  }

  async comeBack() {
    await this.listen(this.port);
  }

  upgrade(request, socket) {
    const { pathname } = new URL(request.url, this.address);
    this.requests.push(pathname);
    const name = /^\/api\/v1\/sessions\/([^/]+)\/live$/.exec(pathname)?.[1];
    const session = name === undefined || this.failure ? undefined : this.sessions.get(decodeURIComponent(name));
    if (!session) return socket.end('HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n');
    this.sockets.add(socket);
    socket.on('close', () => this.sockets.delete(socket));
    FakeLive.accept(request, socket, session);
  }

  async answer(request, response) {
    const url = new URL(request.url, this.address);
    try {
      if (url.pathname === '/readyz') json(response, { status: 'ready', robots: this.robots, damaged: this.damaged });
      else if (url.pathname === '/metrics') this.answerMetrics(response);
      else if (url.pathname.startsWith('/api/') && request.method !== 'GET') await this.change(request, url, response);
      else if (url.pathname.startsWith('/api/')) this.answerApi(url, response);
      else await this.answerFile(url, response);
    } catch (error) {
      problem(response, 500, 'Internal error', String(error));
    }
  }

  async answerFile(url, response) {
    const path = normalize(url.pathname === '/' ? '/index.html' : url.pathname);
    const body = await readFile(join(this.webDirectory, path)).catch(() => null);
    if (!body) return problem(response, 404, 'Not found', path);
    response.writeHead(200, { 'Content-Type': kMediaTypes[extname(path)], ...kSecurityHeaders });
    response.end(body);
  }

  answerMetrics(response) {
    this.metricsRequests += 1;
    response.writeHead(200, { 'Content-Type': 'text/plain; version=0.0.4; charset=utf-8' });
    response.end(this.metrics);
  }

  async change(request, url, response) {
    this.requests.push(`${request.method} ${url.pathname}`);
    let body = '';
    for await (const part of request) body += part;
    const refusal = this.refusal;
    if (!refusal && request.method === 'POST') return this.make(JSON.parse(body), response);
    if (!refusal) this.deleteSession(decodeURIComponent(url.pathname.split('/')[4]));
    await this.hold;
    if (refusal) return problem(response, refusal.status, refusal.title, refusal.detail);
    response.writeHead(204).end();
  }

  make(wanted, response) {
    this.wanted.push(wanted);
    if (this.sessions.has(wanted.name)) {
      return problem(response, 409, 'Exists already', `session '${wanted.name}' exists already`);
    }
    const created = new Date(Date.UTC(2027, 0, this.wanted.length)).toISOString();
    const session = new FakeSession(wanted.name, `made-${this.wanted.length}`, { cellSize: wanted.cell_size, created });
    json(response, this.add(session).toJson(), 201);
  }

  deleteSession(name) {
    this.sessions.delete(name);
    this.damaged = this.damaged.filter((each) => each.name !== name);
  }

  answerApi(url, response) {
    this.requests.push(url.pathname);
    if (this.failure) return problem(response, this.failure.status, this.failure.title, this.failure.detail);
    const [, , , , encodedName, ...rest] = url.pathname.split('/');
    if (encodedName === undefined) {
      const served = [...this.sessions.values()].map((each) => each.toJson());
      const damaged = this.damaged.map((each) => ({ ...each, state: 'damaged' }));
      return json(response, { sessions: [...damaged, ...served], next: null });
    }
    const session = this.sessions.get(decodeURIComponent(encodedName));
    const damaged = this.damaged.find(({ name }) => name === decodeURIComponent(encodedName));
    if (damaged) return problem(response, 500, 'Internal Server Error', damaged.reason);
    if (!session) return problem(response, 404, 'Not found', 'no such session');
    const since = Number(url.searchParams.get('since') ?? 0);
    if (rest.length === 0) return json(response, session.toJson());
    if (rest[0] === 'changes') return json(response, session.changes(url.searchParams.get('layer'), since));
    if (rest[0] === 'trajectory.geojson') return json(response, session.trajectory(since));
    if (rest[0] === 'frontiers.geojson')
      return json(response, { type: 'FeatureCollection', features: session.frontiers });
    if (rest[0] === 'pose_graph.geojson')
      return json(response, { type: 'FeatureCollection', features: session.poseGraph });
    if (rest[0] === 'goals.geojson') {
      const { goals: features, explored } = session;
      return json(response, { type: 'FeatureCollection', explored, features });
    }
    if (rest[0] === 'tiles') return this.answerTile(session, rest.slice(1), url, response);
    return problem(response, 404, 'Not found', url.pathname);
  }

  answerTile(session, [layer, z, x, file], url, response) {
    this.tileRequests.push(url.pathname + url.search);
    if (this.tileFailure) return problem(response, this.tileFailure, 'Too busy', 'try again soon');
    const [y, kind] = file.split('.');
    const code = session.tiles.get(`${z}/${x}/${y}`)?.code;
    const headers = { 'Cache-Control': url.searchParams.has('v') ? 'public, max-age=31536000, immutable' : 'no-cache' };
    const cells = new Uint8Array(kTileSize * kTileSize);
    if (kind === 'bin') {
      response.writeHead(200, { 'Content-Type': 'application/octet-stream', ...headers });
      response.end(cells.fill(code ?? kUntouched[layer]));
    } else {
      response.writeHead(200, { 'Content-Type': 'image/png', ...headers });
      const level = code === undefined ? 128 : kLevelOf[layer](code);
      response.end(encodeGreyPng(kTileSize, kTileSize, cells.fill(level)));
    }
  }
}

function json(response, value, status = 200) {
  response.writeHead(status, { 'Content-Type': 'application/json', 'Cache-Control': 'no-cache' });
  response.end(JSON.stringify(value));
}

function problem(response, status, title, detail) {
  response.writeHead(status, { 'Content-Type': 'application/problem+json' });
  response.end(JSON.stringify({ type: 'about:blank', title, status, detail }));
}
