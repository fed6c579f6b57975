/** Draws frontiers as areas, and the goals from which robots would observe them. */
import Feature from 'ol/Feature';
import LineString from 'ol/geom/LineString';
import MultiPolygon from 'ol/geom/MultiPolygon';
import PointGeometry from 'ol/geom/Point';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import Circle from 'ol/style/Circle';
import Fill from 'ol/style/Fill';
import Stroke from 'ol/style/Stroke';
import Style from 'ol/style/Style';
import type { Frontier } from '../api/types';
import type { Theme } from '../theme';
import { kOrder } from './order';

export class FrontiersLayer {
  private readonly source = new VectorSource();
  readonly layer = new VectorLayer({ source: this.source, zIndex: kOrder.frontiers });

  constructor(private theme: Theme) {
    this.setTheme(theme);
  }

  show(frontiers: Frontier[]): void {
    this.source.clear(true);
    this.source.addFeatures(frontiers.flatMap(featuresOf));
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.layer.setStyle((feature) => this.styles(feature.get('role') as Role));
  }

  private styles(role: Role): Style {
    const { frontier, halo } = this.theme;
    switch (role) {
      case 'reachable':
        return new Style({ fill: new Fill({ color: frontier }), stroke: new Stroke({ color: frontier, width: 2 }) });
      case 'unreachable':
        return new Style({ stroke: new Stroke({ color: frontier, width: 1.5, lineDash: [3, 3] }) });
      case 'reach':
        return new Style({ stroke: new Stroke({ color: frontier, width: 1, lineDash: [2, 4] }) });
      case 'goal':
        return new Style({
          image: new Circle({
            radius: 4.5,
            fill: new Fill({ color: halo }),
            stroke: new Stroke({ color: frontier, width: 2.5 }),
          }),
        });
    }
  }
}

type Role = 'reachable' | 'unreachable' | 'reach' | 'goal';

function featuresOf({ areas, reachable, goal, centroid }: Frontier): Feature[] {
  const role: Role = reachable ? 'reachable' : 'unreachable';
  const features: Feature[] = [new Feature({ geometry: new MultiPolygon(areas), role })];
  if (!goal) return features;
  features.push(new Feature({ geometry: new LineString([goal, centroid]), role: 'reach' }));
  features.push(new Feature({ geometry: new PointGeometry(goal), role: 'goal' }));
  return features;
}
