/**
 * A server whose every answer the test decides: the states that a real one is only in by misfortune.
 * It speaks the part of the HTTP API that the viewer reads, and sends the headers that the real one sends.
 */
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import { encodeGreyPng } from './png.mjs';

const kNativeZoom = 9;
const kTileSize = 256;
const kMediaTypes = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript; charset=utf-8',
  '.css': 'text/css; charset=utf-8',
  '.svg': 'image/svg+xml',
};
const kSecurityHeaders = {
  'Content-Security-Policy':
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; connect-src 'self'",
  'X-Content-Type-Options': 'nosniff',
};

/** A session as the test shapes it; cells are painted tile by tile at the native zoom. */
export class FakeSession {
  constructor(name, id, { cellSize = 0.05, created = '2026-01-02T03:04:05Z' } = {}) {
    Object.assign(this, { name, id, cellSize, created });
    this.revision = 0;
    this.bounds = null;
    this.robots = [];
    this.tracks = new Map();
    this.tiles = new Map();
    /** Why it takes no scans; null: it does. */
    this.failure = null;
  }

  /** Gives a whole native tile one probability of occupation, in percent, and touches what lies above it. */
  paint(x, y, percent) {
    this.revision += 1;
    for (let z = kNativeZoom; z >= 0; --z) {
      const shift = kNativeZoom - z;
      this.tiles.set(`${z}/${x >> shift}/${y >> shift}`, { revision: this.revision, percent });
    }
    this.cover(x, y);
  }

  /** A scan taken here. */
  move(robot, x, y, yaw) {
    this.revision += 1;
    let known = this.robots.find(({ name }) => name === robot);
    if (!known) {
      known = { name: robot, connected: true, scans: 0, last_seq: 0, stamp: 0, pose: null };
      this.robots.push(known);
    }
    known.scans += 1;
    known.last_seq += 1;
    known.pose = { x, y, yaw };
    const track = this.tracks.get(robot) ?? [];
    track.push({ revision: this.revision, point: [x, y] });
    this.tracks.set(robot, track);
  }

  cover(x, y) {
    const side = kTileSize * this.cellSize;
    const box = { min_x: (x - 256) * side, max_x: (x - 255) * side, min_y: (255 - y) * side, max_y: (256 - y) * side };
    const old = this.bounds ?? box;
    this.bounds = {
      min_x: Math.min(old.min_x, box.min_x),
      min_y: Math.min(old.min_y, box.min_y),
      max_x: Math.max(old.max_x, box.max_x),
      max_y: Math.max(old.max_y, box.max_y),
    };
  }

  toJson() {
    return {
      name: this.name,
      ...(this.failure ? { state: 'failed', reason: this.failure } : { state: 'ok' }),
      id: this.id,
      created: this.created,
      revision: this.revision,
      scans: this.robots.reduce((sum, { scans }) => sum + scans, 0),
      config: { cell_size: this.cellSize },
      layers: ['occupancy'],
      bounds: this.bounds,
      robots: this.robots,
    };
  }

  changes(since) {
    const tiles = [];
    for (const [key, { revision }] of this.tiles) {
      const [z, x, y] = key.split('/').map(Number);
      if (revision > since || since > this.revision) tiles.push({ z, x, y, revision });
    }
    return { layer: 'occupancy', since, reset: since > this.revision, revision: this.revision, tiles };
  }

  trajectory(since) {
    const features = [];
    for (const [robot, track] of this.tracks) {
      const coordinates = track.filter(({ revision }) => revision > since).map(({ point }) => point);
      if (coordinates.length === 0) continue;
      const type = coordinates.length < 2 ? 'MultiPoint' : 'LineString';
      const properties = { robot, points: coordinates.length };
      features.push({ type: 'Feature', id: robot, properties, geometry: { type, coordinates } });
    }
    return { type: 'FeatureCollection', frame_id: 'map', units: 'm', revision: this.revision, features };
  }
}

export class FakeServer {
  sessions = new Map();
  /** Path of every request to the API, in order. */
  requests = [];
  /** Path and query of every tile asked for, in order. */
  tileRequests = [];
  /** When set, {status, title, detail}: what every request to the API is answered with. */
  failure = null;
  /** The same for requests that make or delete a session. */
  refusal = null;
  /** What was sent to make sessions, in order. */
  wanted = [];
  /** When set, a promise that what makes or deletes a session waits for before it answers. */
  hold = null;
  /** The text of /metrics. */
  metrics = '';
  metricsRequests = 0;
  /** Sessions that cannot be served, {name, reason}. */
  damaged = [];
  /** Where robots would connect. */
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
    await new Promise((resolve) => this.server.listen(port, '127.0.0.1', resolve));
    this.port = this.server.address().port;
  }

  /** Vanishes as a crashed process does: no more connections, and the open ones break. */
  async vanish() {
    const closed = new Promise((resolve) => this.server.close(resolve));
    this.server.closeAllConnections();
    await closed;
  }

  async comeBack() {
    await this.listen(this.port);
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
    if (rest[0] === 'changes') return json(response, session.changes(since));
    if (rest[0] === 'trajectory.geojson') return json(response, session.trajectory(since));
    if (rest[0] === 'tiles') return this.answerTile(session, rest.slice(2), url, response);
    return problem(response, 404, 'Not found', url.pathname);
  }

  answerTile(session, [z, x, file], url, response) {
    this.tileRequests.push(url.pathname + url.search);
    const [y, kind] = file.split('.');
    const percent = session.tiles.get(`${z}/${x}/${y}`)?.percent;
    const headers = { 'Cache-Control': url.searchParams.has('v') ? 'public, max-age=31536000, immutable' : 'no-cache' };
    const cells = new Uint8Array(kTileSize * kTileSize);
    if (kind === 'bin') {
      response.writeHead(200, { 'Content-Type': 'application/octet-stream', ...headers });
      response.end(cells.fill(percent ?? 255));
    } else {
      response.writeHead(200, { 'Content-Type': 'image/png', ...headers });
      const level = percent === undefined ? 128 : Math.round(255 - 2.55 * percent);
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
