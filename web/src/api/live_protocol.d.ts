/** The API that protocol.js makes of proto/scanloom/v1/live.proto: fields that were not sent have their defaults. */
declare module 'virtual:live-protocol' {
  import type { PbfReader, PbfWriter } from 'pbf';

  interface Pose2 {
    x: number;
    y: number;
    yaw: number;
  }

  interface TileChanges {
    layer: number;
    everything: boolean;
    tiles: number[];
    revisions: number[];
  }

  interface ScanPoints {
    origin: Pose2 | undefined;
    points: number[];
  }

  interface RobotLocalization {
    state: number;
    inliers: number;
    sigma_m: number;
    mount_yaw_error: number;
  }

  interface RobotUpdate {
    robot: number;
    name: string;
    connected: boolean;
    pose: Pose2 | undefined;
    scan_count: number;
    trail: number[];
    trail_from: number;
    scan: ScanPoints | undefined;
    body_radius: number;
    localization: RobotLocalization | undefined;
  }

  interface LiveLandmark {
    id: number;
    x: number;
    y: number;
    seen: number;
    size_x: number;
    size_y: number;
  }

  interface LandmarkChanges {
    landmarks: LiveLandmark[];
    refused: string;
  }

  interface LiveEvent {
    session: string;
    revision: number;
    state: number;
    reason: string;
    counters: { scans: number } | undefined;
    frontiers_revision: number;
    goals_revision: number;
    tiles: TileChanges[];
    robots: RobotUpdate[];
    landmarks: LandmarkChanges | undefined;
    poses_corrected: number;
    moving_scans: number;
  }

  interface LiveRequest {
    layers: number[];
    points: boolean;
    landmarks: boolean;
  }

  export const Layer: Record<string, number>;
  export const SessionState: Record<string, number>;
  export const LocalizationState: Record<string, number>;
  export function readLiveEvent(pbf: PbfReader): LiveEvent;
  export function writeLiveRequest(request: LiveRequest, pbf: PbfWriter): void;
  /** The server encodes events; tests do, too. Fields that are left out have their defaults. */
  export function writeLiveEvent(event: Sparse<LiveEvent>, pbf: PbfWriter): void;
  export function readLiveRequest(pbf: PbfReader): LiveRequest;

  type Sparse<Value> = Value extends (infer Item)[]
    ? Sparse<Item>[]
    : Value extends object
      ? { [Field in keyof Value]?: Sparse<Value[Field]> }
      : Value;
}
