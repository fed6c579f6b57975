/** One chosen session, from the server's events to everything that shows it. */
import type { Session } from './api/types';
import { followSession } from './feed';
import type { Camera } from './map/camera';
import { CellReader } from './map/cell_reader';
import type { MapView } from './map/map_view';
import { TileVersions } from './map/versions';
import type { Cursor } from './panel/cursor';
import type { Facts } from './panel/facts';
import type { Notice } from './panel/notice';
import type { RobotList } from './panel/robot_list';
import type { Status } from './panel/status';
import { RobotColours } from './robot_colours';
import { kRobotColours } from './theme';

export interface ViewerParts {
  map: MapView;
  camera: Camera;
  cursor: Cursor;
  facts: Facts;
  robots: RobotList;
  notice: Notice;
  status: Status;
  details: HTMLElement;
  noRobots: HTMLElement;
  /** Tells the rest of the page what was heard of a session; returns the newest that anybody heard. */
  newest: (session: Session) => Session;
  /** Whether the person has just asked for the end of this session, and needs not be told of it. */
  endIsExpected: (name: string) => boolean;
}

const kSource = 'session';

export class Viewer {
  private leave = new AbortController();
  private colours = new RobotColours(kRobotColours);
  private reading = new AbortController();
  /** Of the session that is shown. */
  private id: string | null = null;

  constructor(private readonly parts: ViewerParts) {}

  /** Leaves the session that is shown, and follows this one. */
  watch(name: string): void {
    this.leave.abort();
    this.leave = new AbortController();
    this.parts.status.forget(kSource);
    this.clear();
    this.parts.notice.show({ kind: 'loading' });
    let seen = false;
    followSession(
      name,
      {
        started: (session) => {
          seen = true;
          this.start(session);
        },
        session: (session) => this.show(this.parts.newest(session)),
        tiles: (tiles) => {
          this.parts.map.showTiles(tiles);
          this.parts.cursor.update();
        },
        tracks: (tracks) => {
          this.parts.map.showTracks(tracks);
          this.parts.robots.refresh();
        },
        gone: () => {
          this.clear();
          if (this.parts.endIsExpected(name)) this.parts.notice.show({ kind: 'loading' });
          else this.parts.notice.show({ kind: seen ? 'deleted' : 'missing', name });
        },
        settled: (error) => {
          this.parts.status.settle(kSource, error);
          if (error === null) this.parts.map.retry();
        },
      },
      this.leave.signal,
    );
  }

  /** Leaves the session that is shown, for none. */
  close(): void {
    this.leave.abort();
    this.parts.status.forget(kSource);
    this.clear();
  }

  /** Something newer was heard of a session, which may be the one that is shown. */
  refresh(session: Session): void {
    if (session.id === this.id) this.show(session);
  }

  private start(session: Session): void {
    this.clear();
    this.id = session.id;
    const versions = new TileVersions();
    this.colours = new RobotColours(kRobotColours);
    this.parts.map.open(session, versions, this.colours);
    const reader = new CellReader(session, versions, this.reading.signal, () => this.parts.cursor.update());
    this.parts.cursor.show({ cellSize: session.cellSize, reader });
    this.parts.details.hidden = false;
    this.show(this.parts.newest(session));
  }

  private show(session: Session): void {
    this.parts.map.showRobots(session);
    this.parts.camera.see(session.bounds, session.robots);
    this.parts.facts.show(session);
    this.parts.robots.show(session.robots, this.colours);
    this.parts.noRobots.hidden = session.robots.length > 0;
    this.parts.notice.show(session.bounds ? { kind: 'none' } : { kind: 'empty', name: session.name });
  }

  private clear(): void {
    this.id = null;
    this.reading.abort();
    this.reading = new AbortController();
    this.parts.map.close();
    this.parts.camera.reset();
    this.parts.cursor.show(null);
    this.parts.robots.clear();
    this.parts.details.hidden = true;
  }
}
