/** The map: its view, its layers, and what of a session is drawn on it. */
import { defaults as defaultInteractions } from 'ol/interaction/defaults';
import OlMap from 'ol/Map';
import Projection from 'ol/proj/Projection';
import View from 'ol/View';
import type { Session, TileChange, Track } from '../api/types';
import type { RobotColours } from '../robot_colours';
import type { Theme } from '../theme';
import { squareExtent, tileResolutions } from './grid';
import { PathLayer } from './path_layer';
import { RobotsLayer } from './robots_layer';
import { LiveTiles } from './tile_layer';
import { TileVersions } from './versions';

/** A cell may be blown up to this many pixels. */
const kCellPxMax = 48;

/** Metres on a plane of the robots' own, tied to no place on Earth. */
const kProjection = new Projection({ code: 'LOCAL', units: 'm' });

/** What is drawn of one session, until it is left. */
interface Scene {
  tiles: LiveTiles;
  paths: PathLayer;
  robots: RobotsLayer;
  leave: AbortController;
}

export function createMap(target: HTMLElement): OlMap {
  return new OlMap({
    target,
    controls: [],
    interactions: defaultInteractions({ altShiftDragRotate: false, pinchRotate: false }),
  });
}

export class MapView {
  private scene: Scene | null = null;

  constructor(
    private readonly map: OlMap,
    private theme: Theme,
  ) {}

  /** Starts with an empty map on this session's grid. */
  open(session: Session, versions: TileVersions, colours: RobotColours): void {
    this.close();
    this.map.setView(viewOf(session.cellSize));
    const leave = new AbortController();
    const resolution = (): number => this.map.getView().getResolution() ?? 0;
    const tiles = new LiveTiles(session, versions, kProjection, resolution, this.theme.cells, leave.signal);
    const paths = new PathLayer(colours, this.theme);
    const robots = new RobotsLayer(colours, this.theme);
    this.map.setLayers([tiles.layer, paths.layer, robots.layer]);
    this.scene = { tiles, paths, robots, leave };
  }

  close(): void {
    this.scene?.leave.abort();
    this.scene = null;
    this.map.setLayers([]);
  }

  showTiles(tiles: TileChange[]): void {
    this.scene?.tiles.apply(tiles);
  }

  showTracks(tracks: Track[]): void {
    this.scene?.paths.append(tracks);
  }

  showRobots(session: Session): void {
    this.scene?.robots.show(session.robots);
  }

  /** Metres travelled. */
  pathLength(robot: string): number {
    return this.scene?.paths.lengthOf(robot) ?? 0;
  }

  /** The server answers again: ask for what could not be had meanwhile. */
  retry(): void {
    this.scene?.tiles.retry();
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.scene?.tiles.setPalette(theme.cells);
    this.scene?.paths.setTheme(theme);
    this.scene?.robots.setTheme(theme);
  }
}

function viewOf(cellSize: number): View {
  return new View({
    projection: kProjection,
    center: [0, 0],
    resolution: 0.02,
    maxResolution: tileResolutions(cellSize)[0],
    minResolution: cellSize / kCellPxMax,
    extent: squareExtent(cellSize),
    constrainOnlyCenter: true,
    smoothExtentConstraint: false,
    enableRotation: false,
  });
}
