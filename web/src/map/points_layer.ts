/** Draws the end points of the beams of each robot's newest scan. */
import Feature from 'ol/Feature';
import MultiPoint from 'ol/geom/MultiPoint';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import Style from 'ol/style/Style';
import type { Point } from '../api/types';
import type { RobotColours } from '../robot_colours';
import type { Theme } from '../theme';
import { kOrder } from './order';

const kSidePx = 3;

export class PointsLayer {
  private readonly source = new VectorSource<Feature<MultiPoint>>();
  readonly layer = new VectorLayer({
    source: this.source,
    zIndex: kOrder.points,
    updateWhileAnimating: true,
    updateWhileInteracting: true,
  });

  constructor(
    private readonly colours: RobotColours,
    private theme: Theme,
  ) {}

  show(robot: string, points: Point[]): void {
    let feature = this.source.getFeatureById(robot) as Feature<MultiPoint> | null;
    if (!feature) {
      feature = new Feature(new MultiPoint([]));
      feature.setId(robot);
      feature.setStyle(this.styleOf(robot));
      this.source.addFeature(feature);
    }
    feature.setGeometry(new MultiPoint(points));
  }

  clear(): void {
    this.source.clear();
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    for (const feature of this.source.getFeatures()) feature.setStyle(this.styleOf(String(feature.getId())));
  }

  private styleOf(robot: string): Style {
    const colour = this.theme.robots[this.colours.indexOf(robot)] ?? this.theme.ink;
    const halo = this.theme.halo;
    return new Style({
      renderer: (pixels, { context, pixelRatio }) => {
        drawSquares(context, pixels as Point[], (kSidePx + 1.5) * pixelRatio, halo);
        drawSquares(context, pixels as Point[], kSidePx * pixelRatio, colour);
      },
    });
  }
}

/** One path for all points: thousands of points are drawn many times a second. */
function drawSquares(context: CanvasRenderingContext2D, places: Point[], side: number, colour: string): void {
  context.beginPath();
  for (const [x, y] of places) context.rect(x - side / 2, y - side / 2, side, side);
  context.fillStyle = colour;
  context.fill();
}
