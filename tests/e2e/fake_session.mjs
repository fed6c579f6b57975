/** A session of the fake server. */
import { eventOf } from './fake_live.mjs';

const kNativeZoom = 9;
const kTileSize = 256;

/** A session that the test changes; cells are painted tile by tile at the native zoom. */
export class FakeSession {
  constructor(name, id, { cellSize = 0.05, created = '2026-01-02T03:04:05Z', number = 1 } = {}) {
    Object.assign(this, { name, id, cellSize, created, number });
    this.revision = 0;
    this.bounds = null;
    this.mainBounds = null;
    this.robots = [];
    this.tracks = new Map();
    this.tiles = new Map();
    /** The layers with tiles: all have the same cells. */
    this.layers = ['occupancy'];
    /** End points of the beams of every robot's newest scan, metres; null: not sent. */
    this.scan = null;
    /** Features of frontiers.geojson. */
    this.frontiers = [];
    /** Landmarks as in events, each with the revision of its newest observation; and why there are no more. */
    this.landmarks = [];
    this.noLandmarks = null;
    /** The pages' subscriptions, in order. */
    this.subscriptions = [];
    /** Features of goals.geojson, and their revision. */
    this.goals = [];
    this.goalsRevision = 0;
    /** Features of pose_graph.geojson, and scans that are being moved to corrected poses. */
    this.poseGraph = [];
    this.movingScans = 0;
    this.localizeOnly = false;
    /** Robots that have explored everything that they can reach. */
    this.explored = [];
    /** Live connections. */
    this.viewers = new Set();
    /** Why it accepts no scans; null: it does. */
    this.failure = null;
  }

  /** Sets all cells of a native tile to one code (occupancy: percent), and updates the tiles above it. */
  paint(x, y, code) {
    this.revision += 1;
    for (let z = kNativeZoom; z >= 0; --z) {
      const shift = kNativeZoom - z;
      this.tiles.set(`${z}/${x >> shift}/${y >> shift}`, { revision: this.revision, code });
    }
    this.cover(x, y);
    this.notify();
  }

  /** Adds a landmark, or another observation of it. */
  see(id, [x, y], seen) {
    this.revision += 1;
    this.landmarks = this.landmarks.filter((each) => each.id !== id);
    this.landmarks.push({ id, x, y, seen, size_x: 0.31, size_y: 0.125, last: this.revision });
    this.notify();
  }

  /** Adds a scan at this pose. */
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
    this.notify();
  }

  notify() {
    for (const viewer of this.viewers) viewer.notify();
  }

  setGoals(features, explored = []) {
    this.goals = features;
    this.explored = explored;
    this.goalsRevision += 1;
    this.notify();
  }

  get scans() {
    return this.robots.reduce((sum, { scans }) => sum + scans, 0);
  }

  liveEvent(since, landmarksSince) {
    return eventOf(this, since, landmarksSince);
  }

  /** Deletes the session. */
  end() {
    for (const viewer of this.viewers) viewer.close(4404, 'the session was deleted');
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
      number: this.number,
      revision: this.revision,
      scans: this.scans,
      localize_only: this.localizeOnly,
      config: { cell_size: this.cellSize },
      layers: this.layers,
      bounds: this.bounds,
      main_bounds: this.mainBounds,
      robots: this.robots,
    };
  }

  changes(layer, since) {
    const tiles = [];
    for (const [key, { revision }] of this.tiles) {
      const [z, x, y] = key.split('/').map(Number);
      if (revision > since || since > this.revision) tiles.push({ z, x, y, revision });
    }
    return { layer, since, reset: since > this.revision, revision: this.revision, tiles };
  }

  trajectory(since) {
    const features = [];
    for (const [robot, track] of this.tracks) {
      const news = track.filter(({ revision }) => revision > since);
      if (news.length === 0) continue;
      const coordinates = news.map(({ point }) => point);
      const revisions = news.map(({ revision }) => revision);
      const type = coordinates.length < 2 ? 'MultiPoint' : 'LineString';
      const times = { revisions, stamps: revisions, yaws: revisions.map(() => 0) };
      const properties = { robot, points: coordinates.length, ...times };
      features.push({ type: 'Feature', id: robot, properties, geometry: { type, coordinates } });
    }
    return { type: 'FeatureCollection', frame_id: 'map', units: 'm', revision: this.revision, features };
  }
}
