/** What the server says, as values of this program. Lengths are metres, angles radians, in the session's map frame. */

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

export interface Robot {
  name: string;
  connected: boolean;
  scans: number;
  pose: Pose | null;
  /** Metres; null: it has not said. */
  bodyRadius: number | null;
}

/** How scans become maps, as the server names it: cell_size, ray_model, p_occupied, ... */
export type MapConfig = Readonly<Record<string, number | string | boolean>>;

export interface Session {
  name: string;
  /** Changes when a session is deleted and another is made under its name, or when the server draws maps otherwise. */
  id: string;
  created: string;
  /** Greater for those that were created later. */
  number: number;
  /** Rises with every scan. */
  revision: number;
  /** Revision of the newest change of exclusions; 0: there is none. */
  exclusions: number;
  scans: number;
  cellSize: number;
  config: MapConfig;
  /** Null while nothing has been seen. */
  bounds: Bounds | null;
  /** Where most of it is; null: not known. One scan with a wrong pose can make `bounds` useless to look at. */
  mainBounds: Bounds | null;
  robots: Robot[];
  /** Why it takes no scans until it is read from the store again; null while it does. */
  failure: string | null;
}

/** A session that the server cannot weave again from its log. */
export interface DamagedSession {
  name: string;
  /** A sentence. */
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
  /** Null: any address of the server will do, so also the one this page came from. */
  host: string | null;
  port: number;
}

/** A tile of the XYZ scheme (y down) and the revision that touched it last. */
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

/** A thing in a room, as lidars see it. */
export interface Landmark {
  id: number;
  at: Point;
  /** By so many captures. */
  seen: number;
  /** Metres along x and y, as it was seen last. */
  size: Point;
}

/** Unexplored ground beside free ground, which hangs together. */
export interface Frontier {
  /** Polygons of rings. */
  areas: Point[][][];
  centroid: Point;
  /** Square metres. */
  area: number;
  /** Whether a robot can get there. */
  reachable: boolean;
  /** Where to stand to see it. */
  goal: Point | null;
}
