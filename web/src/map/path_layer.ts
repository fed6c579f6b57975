/** Where each robot has been. */
import Feature from 'ol/Feature';
import LineString from 'ol/geom/LineString';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import Stroke from 'ol/style/Stroke';
import Style from 'ol/style/Style';
import type { Point } from '../api/types';
import type { RobotColours } from '../robot_colours';
import type { Theme } from '../theme';
import { kOrder } from './order';

export class PathLayer {
  private readonly source = new VectorSource<Feature<LineString>>();
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

  /** @param points oldest first; an array that was shown before may have grown at its end */
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

  private styleOf(robot: string): Style {
    const color = this.theme.robots[this.colours.indexOf(robot)];
    return new Style({ stroke: new Stroke({ color, width: 1.5, lineJoin: 'round', lineCap: 'round' }) });
  }
}

class Path {
  private shown: Point[] = [];
  private drawn = 0;
  private readonly line = new LineString([]);
  readonly feature = new Feature(this.line);

  show(points: Point[]): void {
    if (points === this.shown && points.length === this.drawn) return;
    this.shown = points;
    this.drawn = points.length;
    this.line.setCoordinates(points);
  }
}
