/** The map: its view, its layers, and the overlays of a session. */
import DragPan from 'ol/interaction/DragPan';
import { defaults as defaultInteractions } from 'ol/interaction/defaults';
import KeyboardPan from 'ol/interaction/KeyboardPan';
import KeyboardZoom from 'ol/interaction/KeyboardZoom';
import Kinetic from 'ol/Kinetic';
import type BaseLayer from 'ol/layer/Base';
import OlMap from 'ol/Map';
import View from 'ol/View';
import type { RobotGoal } from '../api/goals';
import type { PoseGraph } from '../api/pose_graph';
import type { Frontier, Landmark, Point, Robot } from '../api/types';
import type { LayerName } from '../layers/layers';
import { motionMs } from '../motion';
import { isTouch } from '../pointing';
import type { RobotColours } from '../robot_colours';
import type { Settings } from '../settings';
import type { Theme } from '../theme';
import { CellLabels } from './cell_labels';
import { CellPane } from './cell_pane';
import type { CellReader } from './cell_reader';
import { FrontiersLayer } from './frontiers_layer';
import { GoalsLayer } from './goals_layer';
import { squareExtent, tileResolutions } from './grid';
import { GridLayer } from './grid_layer';
import { LandmarksLayer } from './landmarks_layer';
import type { MapSource } from './map_source';
import { kOrder } from './order';
import { PathLayer } from './path_layer';
import { PointsLayer } from './points_layer';
import { PoseGraphLayer } from './pose_graph_layer';
import { kProjection } from './projection';
import { RobotsLayer } from './robots_layer';

/** Largest size of a cell in pixels. */
const kCellPxMax = 48;

/** A finger that moves less than this taps: it does not move the map. */
const kTapPx = 6;

const kZoomMs = 250;
const kKeyMs = 100;

/** A layer of some maps. */
export interface Shown {
  source: MapSource;
  layer: LayerName;
}

/** Everything that is drawn for one session, until it is closed. */
interface Scene {
  main: CellPane;
  second: CellPane;
  labels: CellLabels;
  secondLabels: CellLabels;
  grid: GridLayer;
  frontiers: FrontiersLayer;
  landmarks: LandmarksLayer;
  goals: GoalsLayer;
  paths: PathLayer;
  poseGraph: PoseGraphLayer;
  points: PointsLayer;
  robots: RobotsLayer;
}

/** Everything that is drawn over the cells. */
interface MapOverlay {
  layer: BaseLayer;
  setTheme(theme: Theme): void;
}

function overlaysOf({ main: _main, second: _second, ...overlays }: Scene): MapOverlay[] {
  return Object.values(overlays);
}

export function createMap(target: HTMLElement): OlMap {
  return new OlMap({
    target,
    controls: [],
    moveTolerance: isTouch() ? kTapPx : 1,
    interactions: defaultInteractions({
      ...{ altShiftDragRotate: false, pinchRotate: false, keyboard: false, dragPan: false },
      zoomDuration: motionMs(kZoomMs),
    }).extend([
      new DragPan({ kinetic: motionMs(1) > 0 ? new Kinetic(-0.005, 0.05, 100) : undefined }),
      new KeyboardPan({ duration: motionMs(kKeyMs) }),
      new KeyboardZoom({ duration: motionMs(kKeyMs) }),
    ]),
  });
}

export class MapView {
  private scene: Scene | null = null;
  private isOffline = false;

  constructor(
    private readonly map: OlMap,
    private theme: Theme,
    /** Called with the outcome of each tile request: null, or the error. */
    private readonly settled: (error: unknown) => void,
  ) {}

  /** Starts with an empty map on this grid. */
  open(cellSize: number, colours: RobotColours, settings: Settings): void {
    this.close();
    this.map.setView(viewOf(cellSize));
    this.scene = {
      main: new CellPane(this.map, kOrder.cells, this.theme.cells, this.settled),
      second: new CellPane(this.map, kOrder.secondCells, this.theme.cells, this.settled),
      labels: new CellLabels(this.map, this.theme),
      secondLabels: new CellLabels(this.map, this.theme),
      grid: new GridLayer(this.theme),
      frontiers: new FrontiersLayer(this.theme),
      landmarks: new LandmarksLayer(this.theme),
      goals: new GoalsLayer(colours, this.theme),
      paths: new PathLayer(colours, this.theme),
      poseGraph: new PoseGraphLayer(this.theme),
      points: new PointsLayer(colours, this.theme),
      robots: new RobotsLayer(colours, this.theme),
    };
    for (const { layer } of overlaysOf(this.scene)) this.map.addLayer(layer);
    this.setOffline(this.isOffline);
    this.choose(settings);
  }

  close(): void {
    if (!this.scene) return;
    for (const pane of [this.scene.main, this.scene.second]) pane.clear();
    for (const { layer } of overlaysOf(this.scene)) this.map.removeLayer(layer);
    this.scene = null;
  }

  /** Selects the visible overlays. */
  choose({ robots, trails, points, goals, frontiers, landmarks, poseGraph, grid }: Settings): void {
    this.scene?.grid.layer.setVisible(grid);
    this.scene?.robots.layer.setVisible(robots);
    this.scene?.paths.layer.setVisible(trails);
    this.scene?.points.layer.setVisible(points);
    this.scene?.goals.layer.setVisible(goals);
    this.scene?.frontiers.layer.setVisible(frontiers);
    this.scene?.landmarks.layer.setVisible(landmarks);
    this.scene?.poseGraph.layer.setVisible(poseGraph);
  }

  show(main: Shown, second: Shown | null): void {
    this.scene?.main.show(main.source, main.layer);
    if (second) this.scene?.second.show(second.source, second.layer);
    else this.scene?.second.clear();
  }

  /** @param main, second from 0 to 1 */
  setOpacity(main: number, second: number): void {
    this.scene?.main.setOpacity(main);
    this.scene?.second.setOpacity(second);
  }

  /** Position of the dividing line, from 0 on the left to 1; null: the layers overlap. */
  setDivider(at: number | null): void {
    for (const first of [this.scene?.main, this.scene?.labels]) first?.setClip({ from: 0, to: at ?? 1 });
    for (const part of [this.scene?.second, this.scene?.secondLabels]) part?.setClip({ from: at ?? 0, to: 1 });
  }

  /** Called when the shown maps have changed. */
  renew(): void {
    this.scene?.main.renew();
    this.scene?.second.renew();
    this.updateCounters();
  }

  showTrail(robot: string, points: Point[]): void {
    this.scene?.paths.show(robot, points);
  }

  showRobots(robots: Robot[]): void {
    this.scene?.robots.show(robots);
  }

  /** @param isOffline whether the server does not answer */
  setOffline(isOffline: boolean): void {
    this.isOffline = isOffline;
    this.scene?.robots.setOffline(isOffline);
  }

  showScan(robot: string, points: Point[]): void {
    this.scene?.points.show(robot, points);
  }

  clearScans(): void {
    this.scene?.points.clear();
  }

  showGoals(goals: RobotGoal[]): void {
    this.scene?.goals.show(goals);
  }

  showPoseGraph(graph: PoseGraph): void {
    this.scene?.poseGraph.show(graph);
  }

  showFrontiers(frontiers: Frontier[]): void {
    this.scene?.frontiers.show(frontiers);
  }

  /** Adds new landmarks, and those that were observed again. */
  addLandmarks(landmarks: Landmark[]): void {
    this.scene?.landmarks.add(landmarks);
  }

  clearLandmarks(): void {
    this.scene?.landmarks.clear();
  }

  landmarkAt(place: number[]): Landmark | null {
    return this.scene?.landmarks.at(place, this.map.getView().getResolution() ?? 1) ?? null;
  }

  /** @param main, second readers of HIMM counters to draw in the cells of either side; null: none */
  showCounters(main: CellReader | null, second: CellReader | null): void {
    this.scene?.labels.show(main);
    this.scene?.secondLabels.show(second);
  }

  /** Called when requested cells have been loaded. */
  updateCounters(): void {
    this.scene?.labels.update();
    this.scene?.secondLabels.update();
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    if (!this.scene) return;
    for (const pane of [this.scene.main, this.scene.second]) pane.setPalette(theme.cells);
    for (const overlay of overlaysOf(this.scene)) overlay.setTheme(theme);
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
