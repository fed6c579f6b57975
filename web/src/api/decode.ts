/** Converts parsed JSON to values: each function throws a MalformedAnswer that names the first invalid field. */
import type {
  Bounds,
  Changes,
  DamagedSession,
  Localization,
  MapConfig,
  Point,
  Pose,
  Robot,
  RobotPort,
  Session,
  SessionPage,
  TileChange,
  Track,
  Trajectory,
} from './types';

export class MalformedAnswer extends Error {
  override name = 'MalformedAnswer';
}

export type Fields = Record<string, unknown>;

const kLocalizationStates = ['tracking', 'lost', 'unlocated'] as const;

export function decodeSessionPage(json: unknown): SessionPage {
  const page = fields(json, 'sessions');
  const listed = list(page['sessions'], 'sessions').map((each) => fields(each, 'session'));
  return {
    sessions: listed.filter((each) => !isDamaged(each)).map(decodeSession),
    damaged: listed.filter(isDamaged).map(decodeDamaged),
    next: typeof page['next'] === 'string' ? page['next'] : null,
  };
}

function isDamaged(session: Fields): boolean {
  return session['state'] !== undefined && session['state'] !== 'ok' && session['state'] !== 'failed';
}

function decodeDamaged(session: Fields): DamagedSession {
  return { name: text(session['name'], 'name'), reason: text(session['reason'], 'reason') };
}

export function decodeRobotPort(json: unknown): RobotPort {
  const robots = fields(fields(json, 'readiness')['robots'], 'robots');
  return {
    host: robots['host'] == null ? null : text(robots['host'], 'robots.host'),
    port: number(robots['port'], 'robots.port'),
  };
}

export function decodeSession(json: unknown): Session {
  const session = fields(json, 'session');
  const config = decodeConfig(session['config']);
  return {
    name: text(session['name'], 'name'),
    id: text(session['id'], 'id'),
    created: text(session['created'], 'created'),
    number: number(session['number'], 'number'),
    revision: number(session['revision'], 'revision'),
    exclusions: session['exclusions'] == null ? 0 : number(session['exclusions'], 'exclusions'),
    scans: number(session['scans'], 'scans'),
    movingScans: session['moving_scans'] == null ? 0 : number(session['moving_scans'], 'moving_scans'),
    isLocalizeOnly: session['localize_only'] === true,
    cellSize: cellSizeOf(config),
    config,
    bounds: session['bounds'] == null ? null : decodeBounds(session['bounds']),
    mainBounds: session['main_bounds'] == null ? null : decodeBounds(session['main_bounds']),
    robots: list(session['robots'], 'robots').map(decodeRobot),
    failure: session['state'] === 'failed' ? text(session['reason'], 'reason') : null,
  };
}

export function decodeConfig(json: unknown): MapConfig {
  const settings = Object.entries(fields(json, 'config'));
  return Object.fromEntries(settings.filter((pair): pair is [string, Setting] => isSetting(pair[1])));
}

type Setting = MapConfig[string];

function isSetting(value: unknown): value is Setting {
  return ['number', 'string', 'boolean'].includes(typeof value);
}

export function cellSizeOf(config: MapConfig): number {
  const cellSize = number(config['cell_size'], 'config.cell_size');
  if (cellSize <= 0) throw new MalformedAnswer('config.cell_size is not positive');
  return cellSize;
}

export function decodeChanges(json: unknown): Changes {
  const changes = fields(json, 'changes');
  return {
    revision: number(changes['revision'], 'revision'),
    tiles: list(changes['tiles'], 'tiles').map(decodeTileChange),
  };
}

export function decodeTrajectory(json: unknown): Trajectory {
  const collection = fields(json, 'trajectory');
  return {
    revision: number(collection['revision'], 'revision'),
    tracks: list(collection['features'], 'features').map(decodeTrack),
  };
}

function decodeRobot(json: unknown): Robot {
  const robot = fields(json, 'robots[]');
  return {
    name: text(robot['name'], 'robots[].name'),
    connected: robot['connected'] === true,
    scans: number(robot['scans'], 'robots[].scans'),
    pose: robot['pose'] == null ? null : decodePose(robot['pose']),
    bodyRadius: robot['body_radius'] == null ? null : number(robot['body_radius'], 'robots[].body_radius'),
    localization: robot['localization'] == null ? null : decodeLocalization(robot['localization']),
  };
}

/** @return null for a robot that sends poses in the map frame */
function decodeLocalization(json: unknown): Localization | null {
  const known = fields(json, 'localization');
  const state = kLocalizationStates.find((each) => each === known['state']);
  if (!state) return null;
  return {
    state,
    inliers: number(known['inliers'], 'localization.inliers'),
    sigma: number(known['sigma_m'], 'localization.sigma_m'),
    mountError: known['mount_yaw_error'] == null ? 0 : number(known['mount_yaw_error'], 'localization.mount_yaw_error'),
  };
}

export function decodePose(json: unknown): Pose {
  const pose = fields(json, 'pose');
  return { x: number(pose['x'], 'pose.x'), y: number(pose['y'], 'pose.y'), yaw: number(pose['yaw'], 'pose.yaw') };
}

function decodeBounds(json: unknown): Bounds {
  const bounds = fields(json, 'bounds');
  return {
    minX: number(bounds['min_x'], 'bounds.min_x'),
    minY: number(bounds['min_y'], 'bounds.min_y'),
    maxX: number(bounds['max_x'], 'bounds.max_x'),
    maxY: number(bounds['max_y'], 'bounds.max_y'),
  };
}

function decodeTileChange(json: unknown): TileChange {
  const tile = fields(json, 'tiles[]');
  return {
    z: number(tile['z'], 'tiles[].z'),
    x: number(tile['x'], 'tiles[].x'),
    y: number(tile['y'], 'tiles[].y'),
    revision: number(tile['revision'], 'tiles[].revision'),
  };
}

function decodeTrack(json: unknown): Track {
  const feature = fields(json, 'features[]');
  const properties = fields(feature['properties'], 'features[].properties');
  const geometry = feature['geometry'] == null ? {} : fields(feature['geometry'], 'features[].geometry');
  return {
    robot: text(properties['robot'], 'features[].properties.robot'),
    points: list(geometry['coordinates'] ?? [], 'features[].geometry.coordinates').map(decodePoint),
  };
}

export function decodePoint(json: unknown): Point {
  const [x, y] = list(json, 'coordinates[]');
  return [number(x, 'coordinates[].x'), number(y, 'coordinates[].y')];
}

/** Coordinates of a MultiPolygon: polygons made of rings. */
export function decodeAreas(json: unknown): Point[][][] {
  const polygons = list(json, 'coordinates').map((each) => list(each, 'coordinates[]'));
  return polygons.map((rings) => rings.map((ring) => list(ring, 'coordinates[][]').map(decodePoint)));
}

export function fields(value: unknown, where: string): Fields {
  if (typeof value !== 'object' || value === null || Array.isArray(value)) {
    throw new MalformedAnswer(`${where} is not an object`);
  }
  return value as Fields;
}

export function list(value: unknown, where: string): unknown[] {
  if (!Array.isArray(value)) throw new MalformedAnswer(`${where} is not a list`);
  return value;
}

export function number(value: unknown, where: string): number {
  if (typeof value !== 'number' || !Number.isFinite(value)) throw new MalformedAnswer(`${where} is not a number`);
  return value;
}

export function text(value: unknown, where: string): string {
  if (typeof value !== 'string') throw new MalformedAnswer(`${where} is not a text`);
  return value;
}
