/** Draws the robots at their newest poses, each with its heading and name. */
import type { Coordinate } from 'ol/coordinate';
import Feature from 'ol/Feature';
import PointGeometry from 'ol/geom/Point';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import Fill from 'ol/style/Fill';
import Stroke from 'ol/style/Stroke';
import Style from 'ol/style/Style';
import Text from 'ol/style/Text';
import type { Robot } from '../api/types';
import { shortened } from '../format';
import type { RobotColours } from '../robot_colours';
import type { Theme } from '../theme';
import { drawFootprint, drawMarker } from './marker';
import { kOrder } from './order';

const kLabelLengthMax = 24;

export class RobotsLayer {
  private readonly source = new VectorSource<Feature<PointGeometry>>();
  readonly layer = new VectorLayer({
    source: this.source,
    zIndex: kOrder.robots,
    updateWhileAnimating: true,
    updateWhileInteracting: true,
  });
  private robots: Robot[] = [];
  private isOffline = false;

  constructor(
    private readonly colours: RobotColours,
    private theme: Theme,
  ) {}

  show(robots: Robot[]): void {
    this.robots = robots;
    const seen = new Set<string>();
    for (const robot of robots) {
      if (!robot.pose) continue;
      seen.add(robot.name);
      const feature = this.featureOf(robot.name);
      feature.setGeometry(new PointGeometry([robot.pose.x, robot.pose.y]));
      feature.setStyle(this.styleOf(robot, robot.pose.yaw));
    }
    for (const feature of this.source.getFeatures()) {
      if (!seen.has(String(feature.getId()))) this.source.removeFeature(feature);
    }
  }

  /** @param isOffline whether the server does not answer: no robot is drawn as online */
  setOffline(isOffline: boolean): void {
    this.isOffline = isOffline;
    this.show(this.robots);
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.show(this.robots);
  }

  private featureOf(robot: string): Feature<PointGeometry> {
    const known = this.source.getFeatureById(robot);
    if (known instanceof Feature) return known;
    const feature = new Feature<PointGeometry>();
    feature.setId(robot);
    this.source.addFeature(feature);
    return feature;
  }

  private styleOf(robot: Robot, yaw: number): Style[] {
    const colour = this.theme.robots[this.colours.indexOf(robot.name)] ?? this.theme.ink;
    const look = { yaw, colour, halo: this.theme.halo, filled: robot.connected && !this.isOffline };
    return [
      new Style({
        renderer: (at, { context, pixelRatio, resolution }) => {
          const radius = ((robot.bodyRadius ?? 0) / resolution) * pixelRatio;
          if (radius > 0) drawFootprint(context, at as Coordinate, radius, look, pixelRatio);
          drawMarker(context, at as Coordinate, look, pixelRatio);
        },
      }),
      new Style({
        text: new Text({
          text: shortened(robot.name, kLabelLengthMax),
          font: '600 12px system-ui, sans-serif',
          offsetY: -24,
          fill: new Fill({ color: this.theme.ink }),
          stroke: new Stroke({ color: this.theme.halo, width: 4 }),
        }),
      }),
    ];
  }
}
