/** Where each robot has been. */
import Feature from 'ol/Feature';
import LineString from 'ol/geom/LineString';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import Stroke from 'ol/style/Stroke';
import Style from 'ol/style/Style';
import type { Point, Track } from '../api/types';
import type { RobotColours } from '../robot_colours';
import type { Theme } from '../theme';

export class PathLayer {
  private readonly source = new VectorSource<Feature<LineString>>();
  readonly layer: VectorLayer;
  private readonly paths = new Map<string, Path>();

  constructor(
    private readonly colours: RobotColours,
    private theme: Theme,
  ) {
    this.layer = new VectorLayer({ source: this.source, updateWhileAnimating: true, updateWhileInteracting: true });
  }

  append(tracks: Track[]): void {
    for (const { robot, points } of tracks) {
      if (points.length > 0) this.pathOf(robot).append(points);
    }
  }

  /** Metres travelled so far. */
  lengthOf(robot: string): number {
    return this.paths.get(robot)?.length ?? 0;
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
  private readonly points: Point[] = [];
  private readonly line = new LineString([]);
  readonly feature = new Feature(this.line);
  length = 0;

  append(points: Point[]): void {
    for (const point of points) {
      const last = this.points.at(-1);
      if (last) this.length += Math.hypot(point[0] - last[0], point[1] - last[1]);
      this.points.push(point);
    }
    this.line.setCoordinates(this.points);
  }
}
