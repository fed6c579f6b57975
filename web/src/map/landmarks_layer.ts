/** Things that robots saw, those filled that were seen again; from far off only these. */
import Feature from 'ol/Feature';
import PointGeometry from 'ol/geom/Point';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import Circle from 'ol/style/Circle';
import Fill from 'ol/style/Fill';
import RegularShape from 'ol/style/RegularShape';
import Stroke from 'ol/style/Stroke';
import Style from 'ol/style/Style';
import type { Landmark } from '../api/types';
import type { Theme } from '../theme';
import { kOrder } from './order';

type Role = 'once' | 'again';

/** Metres a pixel: from further off, those that were seen once would only hide the map. */
const kNear = 0.04;

/** As far from its middle one is still meant. */
const kHitPx = 8;

export class LandmarksLayer {
  private readonly source = new VectorSource();
  readonly layer = new VectorLayer({ source: this.source, zIndex: kOrder.landmarks });

  constructor(theme: Theme) {
    this.setTheme(theme);
  }

  /** Each takes the place of the one with its number. */
  add(landmarks: Landmark[]): void {
    const known = landmarks.map(({ id }) => this.source.getFeatureById(id)).filter((feature) => feature !== null);
    this.source.removeFeatures(known);
    this.source.addFeatures(landmarks.map(featureOf));
  }

  clear(): void {
    this.source.clear(true);
  }

  /** The one that is seen there, if any: the nearest. @param resolution metres a pixel */
  at([x = 0, y = 0]: number[], resolution: number): Landmark | null {
    if (!this.layer.isVisible()) return null;
    const reach = kHitPx * resolution;
    const around = this.source.getFeaturesInExtent([x - reach, y - reach, x + reach, y + reach]);
    const distance = ({ at }: Landmark): number => Math.hypot(at[0] - x, at[1] - y);
    return around
      .map((feature) => feature.get('landmark') as Landmark)
      .filter(({ seen }) => resolution <= kNear || seen > 1)
      .reduce<Landmark | null>((best, each) => (best && distance(best) <= distance(each) ? best : each), null);
  }

  setTheme(theme: Theme): void {
    const near = stylesOf(theme);
    const far = dotOf(theme);
    this.layer.setStyle((feature, resolution) => {
      const role = feature.get('role') as Role;
      if (resolution <= kNear) return near[role];
      return role === 'again' ? far : [];
    });
  }
}

function featureOf(landmark: Landmark): Feature {
  const role: Role = landmark.seen > 1 ? 'again' : 'once';
  const feature = new Feature({ geometry: new PointGeometry(landmark.at), role, landmark });
  feature.setId(landmark.id);
  return feature;
}

function dotOf({ landmark }: Theme): Style {
  return new Style({ image: new Circle({ radius: 3, fill: new Fill({ color: landmark }) }) });
}

function stylesOf({ landmark, halo }: Theme): Record<Role, Style> {
  const diamond = (radius: number, fill: string, stroke: string): Style =>
    new Style({
      image: new RegularShape({
        points: 4,
        radius,
        fill: new Fill({ color: fill }),
        stroke: new Stroke({ color: stroke, width: 1.5 }),
      }),
    });
  return {
    once: diamond(4, halo, landmark),
    again: diamond(6, landmark, halo),
  };
}
