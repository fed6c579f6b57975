/** The server's answers as values of this program. Lengths are metres, angles radians, in the session's map frame. */

export interface Bounds {
  minX: number;
  minY: number;
  maxX: number;
  maxY: number;
}

export interface Pose {
  x: number;
  y: number;
  yaw: number;
}

/** How well the server knows the poses of a robot that sends no poses in the map frame. */
export interface Localization {
  /** unlocated: its place in the map is not known yet. */
  state: 'tracking' | 'lost' | 'unlocated';
  /** Share of the newest scan's points that fit the map, 0 to 1. */
  inliers: number;
  /** Standard deviation of the newest position, metres. */
  sigma: number;
  /** By how much the yaw of the laser's mount seems to be too large, radians; 0: it seems to be right. */
  mountError: number;
}

export interface Robot {
  name: string;
  connected: boolean;
  scans: number;
  pose: Pose | null;
  /** Metres; null: not reported. */
  bodyRadius: number | null;
  /** Null: the robot sends poses in the map frame. */
  localization: Localization | null;
}

/** The mapping settings by the server's names: cell_size, ray_model, p_occupied, ... */
export type MapConfig = Readonly<Record<string, number | string | boolean>>;

export interface Session {
  name: string;
  /** Changes when a session is deleted and recreated under its name, or when the server draws maps differently. */
  id: string;
  created: string;
  /** Greater for those that were created later. */
  number: number;
  /** Increases with every scan. */
  revision: number;
  /** Revision of the newest change of exclusions; 0: none. */
  exclusions: number;
  scans: number;
  /** Scans that the map does not show at their corrected poses yet. */
  movingScans: number;
  /** Robots are located in the map, which does not change. */
  isLocalizeOnly: boolean;
  cellSize: number;
  config: MapConfig;
  /** Null while the map is empty. */
  bounds: Bounds | null;
  /**
   * Bounds of the largest connected part; null: unknown. One scan with a wrong pose can make `bounds` useless for the
   * view.
   */
  mainBounds: Bounds | null;
  robots: Robot[];
  /** Why the session accepts no scans until it is reloaded from the store; null while it does. */
  failure: string | null;
}

/** A session whose map the server cannot reconstruct from its log. */
export interface DamagedSession {
  name: string;
  /** A sentence that says why. */
  reason: string;
}

export interface Sessions {
  sessions: Session[];
  damaged: DamagedSession[];
}

export interface SessionPage extends Sessions {
  next: string | null;
}

/** Where robots connect. */
export interface RobotPort {
  /** Null: any address of the server, therefore also the address of this page. */
  host: string | null;
  port: number;
}

/** A tile of the XYZ scheme (y down) and the revision of its last change. */
export interface TileChange {
  z: number;
  x: number;
  y: number;
  revision: number;
}

export interface Changes {
  revision: number;
  tiles: TileChange[];
}

export type Point = [x: number, y: number];

/** A part of one robot's path, oldest position first. */
export interface Track {
  robot: string;
  points: Point[];
}

export interface Trajectory {
  revision: number;
  tracks: Track[];
}

/** A landmark: an object in a room, as lidars observe it. */
export interface Landmark {
  id: number;
  at: Point;
  /** Number of observations. */
  seen: number;
  /** Size along x and y at the last observation, metres. */
  size: Point;
}

/** A connected area of unexplored ground next to free ground. */
export interface Frontier {
  /** Polygons made of rings. */
  areas: Point[][][];
  centroid: Point;
  /** Square metres. */
  area: number;
  /** Whether a robot can reach it. */
  reachable: boolean;
  /** Where a robot has to stand to observe it. */
  goal: Point | null;
}
