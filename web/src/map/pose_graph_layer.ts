/** Draws the pose graph: keyframes as dots, matches as thin lines, loops as arcs; unused edges are dashed. */
import Feature from 'ol/Feature';
import MultiLineString from 'ol/geom/MultiLineString';
import MultiPoint from 'ol/geom/MultiPoint';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import Circle from 'ol/style/Circle';
import Fill from 'ol/style/Fill';
import Stroke from 'ol/style/Stroke';
import Style from 'ol/style/Style';
import type { GraphEdge, PoseGraph } from '../api/pose_graph';
import type { Point } from '../api/types';
import type { Theme } from '../theme';
import { arcOf } from './arc';
import { kOrder } from './order';

const kKeyframePx = 2;
const kEdgePx = 1;
const kDashes = [4, 4];
/** Opacity, in hexadecimal: walls stay visible through thousands of edges. */
const kOpacity = 'a6';

export class PoseGraphLayer {
  private readonly source = new VectorSource();
  readonly layer = new VectorLayer({ source: this.source, zIndex: kOrder.poseGraph });

  constructor(theme: Theme) {
    this.setTheme(theme);
  }

  show({ keyframes, edges }: PoseGraph): void {
    const lines = (isLoop: boolean, isUsed: boolean): Feature => {
      const chosen = edges.filter((edge) => edge.isLoop === isLoop && edge.isUsed === isUsed);
      return new Feature({ geometry: new MultiLineString(chosen.map(lineOf)), isLoop, isUsed });
    };
    this.source.clear(true);
    this.source.addFeatures([
      ...[lines(false, true), lines(false, false), lines(true, true), lines(true, false)],
      new Feature({ geometry: new MultiPoint(keyframes), isKeyframe: true }),
    ]);
  }

  setTheme({ ink, loop }: Theme): void {
    const keyframe = new Style({ image: new Circle({ radius: kKeyframePx, fill: new Fill({ color: ink }) }) });
    this.layer.setStyle((feature) => {
      if (feature.get('isKeyframe') === true) return keyframe;
      const isLoop = feature.get('isLoop') === true;
      const lineDash = feature.get('isUsed') === true ? undefined : kDashes;
      const color = `${isLoop ? loop : ink}${kOpacity}`;
      return new Style({ stroke: new Stroke({ color, width: kEdgePx, lineDash }) });
    });
  }
}

function lineOf({ from, to, isLoop }: GraphEdge): Point[] {
  return isLoop ? arcOf(from, to) : [from, to];
}
