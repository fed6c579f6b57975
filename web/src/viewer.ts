/** Connects one open session, from the server's events to all parts that show it. */
import { fetchFrontiers } from './api/frontiers';
import { fetchGoals, type Goals } from './api/goals';
import { Refused } from './api/http';
import type { LandmarkUpdate, LiveEvent, LiveRobot } from './api/live';
import { fetchPoseGraph, type PoseGraph } from './api/pose_graph';
import type { Frontier, Robot, Session, TileChange } from './api/types';
import { kLayers, type LayerName } from './layers/layers';
import { Feed } from './live/feed';
import type { Trail, Trails } from './live/trails';
import type { Camera } from './map/camera';
import type { CellReader } from './map/cell_reader';
import { CellReaders } from './map/cell_readers';
import { LiveSource, ownFamily, type MapSource } from './map/map_source';
import type { MapView, Shown } from './map/map_view';
import type { Cursor } from './panel/cursor';
import type { EstimateButton } from './panel/estimate_button';
import type { Facts } from './panel/facts';
import type { ExploredNote } from './panel/explored_note';
import type { ModeButton } from './panel/mode_button';
import type { Notice } from './panel/notice';
import type { RobotList } from './panel/robot_list';
import { Draining, type Status } from './panel/status';
import type { Picture } from './picture';
import { RobotColours } from './robot_colours';
import { RevisionWatch } from './revision_watch';
import type { SettingsStore } from './settings';
import { kRobotColours } from './theme';

export interface ViewerParts {
  map: MapView;
  picture: Picture;
  camera: Camera;
  cursor: Cursor;
  facts: Facts;
  mode: ModeButton;
  estimate: EstimateButton;
  robots: RobotList;
  notice: Notice;
  explored: ExploredNote;
  status: Status;
  settings: SettingsStore;
  details: HTMLElement;
  noRobots: HTMLElement;
  /** Passes a session state to the rest of the page; returns the newest known state. */
  newest: (session: Session) => Session;
  /** Polls all sessions soon, because of a change that the live connection does not report. */
  refresh: () => void;
  /** Whether the user is deleting this session, so that its end needs no message. */
  endIsExpected: (name: string) => boolean;
}

/** A session at an earlier time. */
export interface Moment {
  source: MapSource;
  robots: Robot[];
  /** By robot. */
  trails: Map<string, Trail>;
}

/** State of the open session. */
interface Open {
  session: Session;
  source: LiveSource;
  trails: Trails;
  /** By number. */
  robots: Map<number, Robot>;
  frontiers: RevisionWatch<Frontier[]>;
  goals: RevisionWatch<Goals>;
  poseGraph: RevisionWatch<PoseGraph>;
  /** The landmarks on the map are from an earlier connection, perhaps from before a restart of the server. */
  landmarksAreOld: boolean;
  readers: CellReaders;
  /** It has no scan yet. */
  isNew: boolean;
}

const kSource = 'session';
const kServerState = 'server state';
const kLandmarks = 'landmarks';

/** The status line's code for a full server. */
const kNoRoom = 507;
const kNothingOfThePresent = { points: false, frontiers: false, goals: false, landmarks: false, poseGraph: false };

/** The pose graph is fetched again after this many scans, and after corrections. */
const kScansPerGraph = 500;

export class Viewer {
  private leave = new AbortController();
  private reading = new AbortController();
  private colours = new RobotColours(kRobotColours);
  private feed: Feed | null = null;
  private open: Open | null = null;
  private moment: Moment | null = null;
  private readonly listeners: ((session: Session | null) => void)[] = [];

  constructor(private readonly parts: ViewerParts) {
    parts.settings.listen(() => this.choose());
    parts.picture.listen(() => this.showCounters());
  }

  /** The open session in its newest known state. */
  get session(): Session | null {
    return this.open?.session ?? null;
  }

  get robots(): Robot[] {
    return [...(this.open?.robots.values() ?? [])];
  }

  /** Calls the listener when a session is opened, and with null when it is closed. */
  listen(listener: (session: Session | null) => void): void {
    this.listeners.push(listener);
  }

  /** Closes the shown session, and follows this one. */
  watch(name: string): void {
    this.leave.abort();
    this.leave = new AbortController();
    this.parts.status.forget(kSource);
    this.parts.status.forget(kServerState);
    this.clear();
    this.parts.notice.show({ kind: 'loading' });
    let seen = false;
    const { status, notice } = this.parts;
    this.feed = new Feed(
      name,
      {
        started: (session, trails) => {
          seen = true;
          this.start(session, trails);
        },
        opened: () => {
          this.open?.frontiers.invalidate();
          this.open?.goals.invalidate();
          this.open?.poseGraph.invalidate();
          if (this.open) this.open.landmarksAreOld = true;
        },
        event: (event) => this.apply(event),
        tiles: (layer, tiles) => this.showTiles(layer, tiles),
        trails: () => this.showTrails(),
        corrected: (trails) => {
          if (this.open) this.open.trails = trails;
        },
        gone: () => {
          this.clear();
          if (this.parts.endIsExpected(name)) notice.show({ kind: 'loading' });
          else notice.show({ kind: seen ? 'deleted' : 'missing', name });
        },
        settled: (error) => status.settle(kSource, error),
      },
      this.leave.signal,
    );
    this.feed.subscribe(this.parts.settings.get());
    this.feed.run();
  }

  /** Closes the shown session. */
  close(): void {
    this.leave.abort();
    this.parts.status.forget(kSource);
    this.parts.status.forget(kServerState);
    this.clear();
  }

  /** Updates the shown session, if this is a newer state of it. */
  refresh(session: Session): void {
    if (!this.open || session.id !== this.open.session.id) return;
    this.feed?.expect(session.revision);
    this.open.session = session;
    this.showSession();
  }

  /** Shows the session at an earlier time; null: returns to the present. */
  showMoment(moment: Moment | null): void {
    if (!this.open) return;
    this.moment = moment;
    this.parts.picture.showMoment(moment?.source ?? null);
    this.chooseOverlays();
    this.showRobots();
    this.showTrails();
    this.showSession();
  }

  private start(session: Session, trails: Trails): void {
    this.clear();
    const { map, picture, cursor, details, settings, newest } = this.parts;
    this.colours = new RobotColours(kRobotColours);
    const source = new LiveSource(session, session.cellSize, ownFamily(session.exclusions));
    const readers = new CellReaders(this.reading.signal, () => {
      cursor.update();
      map.updateCounters();
    });
    const { name } = session;
    const { signal } = this.reading;
    this.open = {
      session: newest(session),
      source,
      trails,
      robots: new Map(),
      frontiers: new RevisionWatch(
        (stop) => fetchFrontiers(name, stop),
        (all) => map.showFrontiers(all),
        signal,
      ),
      goals: new RevisionWatch(
        (stop) => fetchGoals(name, stop),
        (all) => this.showGoals(all),
        signal,
      ),
      poseGraph: new RevisionWatch(
        (stop) => fetchPoseGraph(name, stop),
        (graph) => map.showPoseGraph(graph),
        signal,
      ),
      landmarksAreOld: false,
      readers,
      isNew: true,
    };
    map.open(session.cellSize, this.colours, settings.get());
    picture.open(source);
    cursor.show({ readers, picture, landmarkAt: (place) => map.landmarkAt(place) });
    details.hidden = false;
    this.choose();
    session.robots.forEach((robot, index) => this.open?.robots.set(index, robot));
    this.showRobots();
    this.showSession();
    for (const listener of this.listeners) listener(session);
  }

  private apply(event: LiveEvent): void {
    if (!this.open) return;
    this.parts.status.settle(kServerState, event.draining ? new Draining() : null);
    const { robots, frontiers, goals, poseGraph, session } = this.open;
    for (const robot of event.robots) robots.set(robot.index, robotOf(robot));
    if (this.open.isNew && event.scans > 0) {
      this.open.isNew = false;
      this.leaveEmptyLayer(event);
    }
    frontiers.setRevision(event.frontiersRevision);
    goals.setRevision(event.goalsRevision);
    poseGraph.setRevision(event.posesCorrected + Math.floor(event.scans / kScansPerGraph));
    if (event.landmarks) this.applyLandmarks(event.landmarks);
    const { revision, scans, movingScans } = event;
    this.open.session = { ...session, revision, scans, movingScans, robots: this.robots };
    this.parts.newest(this.open.session);
    if (!session.bounds && event.scans > 0) this.parts.refresh();
    for (const { name, scan } of event.robots) if (scan) this.parts.map.showScan(name, scan.points);
    if (this.moment) return this.showSession();
    this.showRobots();
    this.showTrails();
    this.showSession();
  }

  private applyLandmarks(update: LandmarkUpdate): void {
    if (!this.open) return;
    if (this.open.landmarksAreOld) this.parts.map.clearLandmarks();
    this.open.landmarksAreOld = false;
    this.parts.map.addLandmarks(update.landmarks);
    this.parts.status.settle(kLandmarks, update.refused === null ? null : new Refused(kNoRoom, update.refused));
  }

  /** A session of sonars has no laser layers, and the reverse: selects a layer with data. */
  private leaveEmptyLayer({ tiles }: LiveEvent): void {
    const held = new Set(tiles.filter((each) => each.everything || each.tiles.length > 0).map(({ layer }) => layer));
    const other = kLayers.find((layer) => held.has(layer));
    if (other !== undefined && !held.has(this.parts.picture.now.layer)) this.parts.picture.change({ layer: other });
  }

  private showTiles(layer: LayerName, tiles: TileChange[]): void {
    this.open?.source.apply(layer, tiles);
    this.parts.cursor.update();
  }

  private showSession(): void {
    if (!this.open) return;
    const { session } = this.open;
    this.parts.facts.show(session);
    this.parts.mode.show(session);
    this.parts.estimate.show(session);
    this.parts.noRobots.hidden = this.open.robots.size > 0;
    this.parts.camera.see(session.mainBounds ?? session.bounds, this.moment?.robots ?? this.robots);
    this.parts.notice.show(session.bounds ? { kind: 'none' } : { kind: 'empty', name: session.name });
  }

  private showGoals({ ofRobots, explored }: Goals): void {
    this.parts.map.showGoals(ofRobots);
    this.parts.explored.show(explored);
  }

  private showRobots(): void {
    const robots = this.moment?.robots ?? this.robots;
    this.parts.map.showRobots(robots);
    this.parts.robots.show(robots, this.colours);
  }

  private showTrails(): void {
    for (const { name } of this.robots) this.parts.map.showTrail(name, this.trailOf(name)?.points ?? []);
    this.parts.robots.refresh();
  }

  /** Metres travelled. */
  pathLength(robot: string): number {
    return this.trailOf(robot)?.length ?? 0;
  }

  private trailOf(robot: string): Trail | undefined {
    return this.moment ? this.moment.trails.get(robot) : this.open?.trails.get(robot);
  }

  private choose(): void {
    const settings = this.parts.settings.get();
    this.feed?.subscribe(settings);
    if (!settings.points) this.parts.map.clearScans();
    if (!settings.landmarks) this.parts.status.forget(kLandmarks);
    this.chooseOverlays();
    this.showCounters();
  }

  /** Newest scans, frontiers, goals and landmarks are available for the present only. */
  private chooseOverlays(): void {
    const chosen = this.parts.settings.get();
    const settings = this.moment ? { ...chosen, ...kNothingOfThePresent } : chosen;
    this.parts.map.choose(settings);
    this.open?.frontiers.enable(settings.frontiers);
    this.open?.goals.enable(!this.moment);
    this.open?.poseGraph.enable(settings.poseGraph);
    this.parts.explored.setHidden(this.moment !== null);
  }

  private showCounters(): void {
    const { map, picture, settings } = this.parts;
    const readers = settings.get().counters ? this.open?.readers : undefined;
    const of = (shown: Shown | null): CellReader | null => (shown && readers ? readers.of(shown.source, 'himm') : null);
    // Where the layers overlap, two numbers in a cell would be unreadable.
    map.showCounters(of(picture.main), picture.isSwiping ? of(picture.second) : null);
  }

  private clear(): void {
    const wasOpen = this.open !== null;
    this.open = null;
    this.moment = null;
    this.parts.status.forget(kLandmarks);
    this.reading.abort();
    this.reading = new AbortController();
    this.parts.picture.open(null);
    this.parts.map.close();
    this.parts.camera.reset();
    this.parts.cursor.show(null);
    this.parts.robots.clear();
    this.parts.explored.show([]);
    this.parts.details.hidden = true;
    if (wasOpen) for (const listener of this.listeners) listener(null);
  }
}

function robotOf({ name, connected, scans, pose, bodyRadius, localization }: LiveRobot): Robot {
  return { name, connected, scans, pose, bodyRadius, localization };
}
