/** Draws the robots' trails, fainter than the walls below them. */
import Feature from 'ol/Feature';
import MultiLineString from 'ol/geom/MultiLineString';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import Stroke from 'ol/style/Stroke';
import Style from 'ol/style/Style';
import type { Point } from '../api/types';
import type { RobotColours } from '../robot_colours';
import type { Theme } from '../theme';
import { kOrder } from './order';
import { TrailParts } from './trail_parts';

/** Opacity, in hexadecimal: walls stay visible through trails. */
const kOpacity = 'a6';
/** Metres per pixel: at coarser zooms, lines are as thin as walls. */
const kNear = 0.04;
const kNearPx = 1.5;
const kFarPx = 1;

export class PathLayer {
  private readonly source = new VectorSource<Feature<MultiLineString>>();
  readonly layer = new VectorLayer({
    source: this.source,
    zIndex: kOrder.trails,
    updateWhileAnimating: true,
    updateWhileInteracting: true,
  });
  private readonly paths = new Map<string, Path>();

  constructor(
    private readonly colours: RobotColours,
    private theme: Theme,
  ) {}

  /** @param points oldest first; an array that was passed before may have grown at its end */
  show(robot: string, points: Point[]): void {
    this.pathOf(robot).show(points);
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    for (const [robot, path] of this.paths) path.feature.setStyle(this.styleOf(robot));
  }

  private pathOf(robot: string): Path {
    let path = this.paths.get(robot);
    if (!path) {
      path = new Path();
      path.feature.setStyle(this.styleOf(robot));
      this.paths.set(robot, path);
      this.source.addFeature(path.feature);
    }
    return path;
  }

  private styleOf(robot: string): (feature: unknown, resolution: number) => Style {
    const color = `${this.theme.robots[this.colours.indexOf(robot)] ?? this.theme.ink}${kOpacity}`;
    const style = (width: number): Style =>
      new Style({ stroke: new Stroke({ color, width, lineJoin: 'round', lineCap: 'round' }) });
    const [near, far] = [style(kNearPx), style(kFarPx)];
    return (_feature, resolution) => (resolution <= kNear ? near : far);
  }
}

class Path {
  private shown: Point[] = [];
  private drawn = 0;
  private trail = new TrailParts();
  private readonly lines = new MultiLineString([]);
  readonly feature = new Feature(this.lines);

  show(points: Point[]): void {
    if (points === this.shown && points.length === this.drawn) return;
    if (points !== this.shown || points.length < this.drawn) this.restart(points);
    this.trail.add(points.slice(this.drawn));
    this.drawn = points.length;
    this.lines.setCoordinates(this.trail.parts);
  }

  private restart(points: Point[]): void {
    this.shown = points;
    this.drawn = 0;
    this.trail = new TrailParts();
  }
}
