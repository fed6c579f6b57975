/** Encodes and decodes the messages of the live connection. */
import { PbfReader, PbfWriter } from 'pbf';
import {
  Layer,
  LocalizationState,
  readLiveEvent,
  SessionState,
  writeLiveRequest,
  type LandmarkChanges,
  type RobotLocalization,
  type RobotUpdate,
  type ScanPoints,
  type TileChanges,
} from 'virtual:live-protocol';
import { kNativeZoom } from '../map/grid';
import type { LayerName } from '../layers/layers';
import { decodePose, MalformedAnswer } from './decode';
import type { Landmark, Localization, Point, Pose, TileChange } from './types';

const kTilesAcross = 2 ** kNativeZoom;
const kMillimetre = 0.001;

const kLayerOfNumber = new Map<number, LayerName>([
  [Layer['LAYER_OCCUPANCY'] ?? 1, 'occupancy'],
  [Layer['LAYER_HIMM'] ?? 2, 'himm'],
  [Layer['LAYER_SONAR'] ?? 3, 'sonar'],
  [Layer['LAYER_CLASSIFICATION'] ?? 4, 'classification'],
]);

const kStateOfNumber = new Map<number, Localization['state']>([
  [LocalizationState['LOCALIZATION_STATE_TRACKING'] ?? 1, 'tracking'],
  [LocalizationState['LOCALIZATION_STATE_LOST'] ?? 2, 'lost'],
  [LocalizationState['LOCALIZATION_STATE_UNLOCATED'] ?? 3, 'unlocated'],
]);

export interface LiveTiles {
  layer: LayerName;
  /** Too many tiles to list: fetch all changes. */
  everything: boolean;
  /** Tiles of the native zoom. */
  tiles: TileChange[];
}

export interface LiveScan {
  /** T_map_sensor. */
  origin: Pose;
  /** End points of the beams, in the map frame. */
  points: Point[];
}

export interface LiveRobot {
  /** The robot's number in the session. */
  index: number;
  name: string;
  connected: boolean;
  scans: number;
  /** Null before its first scan. */
  pose: Pose | null;
  /** Metres; null: not reported. */
  bodyRadius: number | null;
  /** Null: it sends poses in the map frame. */
  localization: Localization | null;
  trail: Point[];
  /** Number of points of the trail before these. */
  trailFrom: number;
  /** Null: unchanged. */
  scan: LiveScan | null;
}

export interface LandmarkUpdate {
  /** New landmarks, and those that were observed again. */
  landmarks: Landmark[];
  /** Why the server stopped extracting landmarks; null: it did not. */
  refused: string | null;
}

/** The data that a page subscribes to, in addition to tiles and robots. */
export interface Subscription {
  /** The newest scans. */
  points: boolean;
  landmarks: boolean;
}

export interface LiveEvent {
  /** The session's revision. */
  id: string;
  revision: number;
  scans: number;
  /** Why the session accepts no scans; null: it does. */
  failure: string | null;
  /** The server is shutting down. */
  draining: boolean;
  /** Increases when frontiers may have changed. */
  frontiersRevision: number;
  /** Increases when the robots' goals or paths have changed. */
  goalsRevision: number;
  /** Changes when the map has followed corrected poses of earlier scans: trails known before are outdated. */
  posesCorrected: number;
  /** Scans that the map does not show at their corrected poses yet. */
  movingScans: number;
  tiles: LiveTiles[];
  /** Robots that changed. */
  robots: LiveRobot[];
  /** Null: unchanged, or not subscribed to. */
  landmarks: LandmarkUpdate | null;
}

export function decodeLiveEvent(bytes: ArrayBuffer): LiveEvent {
  try {
    const event = readLiveEvent(new PbfReader(new Uint8Array(bytes)));
    return {
      id: event.session,
      revision: event.revision,
      scans: event.counters?.scans ?? 0,
      failure: event.state === SessionState['SESSION_STATE_FAILED'] ? event.reason : null,
      draining: event.state === SessionState['SESSION_STATE_DRAINING'],
      frontiersRevision: event.frontiers_revision,
      goalsRevision: event.goals_revision,
      posesCorrected: event.poses_corrected,
      movingScans: event.moving_scans,
      tiles: event.tiles.flatMap(decodeTiles),
      robots: event.robots.map(decodeRobot),
      landmarks: event.landmarks ? decodeLandmarks(event.landmarks) : null,
    };
  } catch (error) {
    throw error instanceof MalformedAnswer ? error : new MalformedAnswer(`a live event (${String(error)})`);
  }
}

/** Subscribes to the tiles of all layers and to the chosen data. */
export function encodeLiveRequest(subscription: Subscription): Uint8Array<ArrayBuffer> {
  const writer = new PbfWriter();
  writeLiveRequest({ layers: [...kLayerOfNumber.keys()], ...subscription }, writer);
  return new Uint8Array(writer.finish());
}

/** Returns nothing for a layer that this program does not know. */
function decodeTiles({ layer, everything, tiles, revisions }: TileChanges): LiveTiles[] {
  const name = kLayerOfNumber.get(layer);
  if (!name) return [];
  if (tiles.length !== revisions.length) throw new MalformedAnswer('a live event has not one revision for each tile');
  const changes = tiles.map((tile, index) => ({
    z: kNativeZoom,
    x: tile % kTilesAcross,
    y: Math.floor(tile / kTilesAcross),
    revision: revisions[index] ?? 0,
  }));
  return [{ layer: name, everything, tiles: changes }];
}

function decodeRobot(robot: RobotUpdate): LiveRobot {
  return {
    index: robot.robot,
    name: robot.name,
    connected: robot.connected,
    scans: robot.scan_count,
    pose: robot.pose ? decodePose(robot.pose) : null,
    bodyRadius: robot.body_radius ? robot.body_radius : null,
    localization: robot.localization ? decodeLocalization(robot.localization) : null,
    trail: pointsOf(robot.trail, 0, 0),
    trailFrom: robot.trail_from,
    scan: robot.scan ? decodeScan(robot.scan) : null,
  };
}

function decodeLocalization({ state, inliers, sigma_m, mount_yaw_error }: RobotLocalization): Localization | null {
  const known = kStateOfNumber.get(state);
  return known ? { state: known, inliers, sigma: sigma_m, mountError: mount_yaw_error } : null;
}

function decodeLandmarks({ landmarks, refused }: LandmarkChanges): LandmarkUpdate {
  return {
    landmarks: landmarks.map(({ id, x, y, seen, size_x, size_y }) => ({
      id,
      at: [x, y],
      seen,
      size: [size_x, size_y],
    })),
    refused: refused === '' ? null : refused,
  };
}

function decodeScan({ origin, points }: ScanPoints): LiveScan {
  const pose = origin ? decodePose(origin) : { x: 0, y: 0, yaw: 0 };
  return { origin: pose, points: pointsOf(points, pose.x, pose.y) };
}

/** @param differences millimetres: x, y of the first from (x, y), then of each from the one before it */
function pointsOf(differences: number[], x: number, y: number): Point[] {
  if (differences.length % 2 !== 0) throw new MalformedAnswer('a live event has half a point');
  const points: Point[] = [];
  let [column, row] = [0, 0];
  for (let at = 0; at < differences.length; at += 2) {
    column += differences[at] ?? 0;
    row += differences[at + 1] ?? 0;
    points.push([x + column * kMillimetre, y + row * kMillimetre]);
  }
  return points;
}
