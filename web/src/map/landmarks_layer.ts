/** Draws landmarks: a diamond for several observations, a triangle for one; fewer symbols at coarse zooms. */
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
import { thin } from './thinning';

type Role = 'once' | 'again';

/** Metres per pixel: at coarser zooms, landmarks with one observation would only cover the map. */
const kNear = 0.04;

/** Of landmarks closer together than about this, one is drawn. */
const kSpacingPx = 28;

/** Largest distance from its centre at which a landmark is picked. */
const kHitPx = 8;

export class LandmarksLayer {
  private readonly source = new VectorSource();
  readonly layer = new VectorLayer({ source: this.source, zIndex: kOrder.landmarks });

  /** Landmarks that are drawn at the zoom of `drawnSide`; null: to be selected again. */
  private drawn: Set<number> | null = null;
  private drawnSide = 0;

  constructor(theme: Theme) {
    this.setTheme(theme);
  }

  /** Adds landmarks; each replaces the one with the same number. */
  add(landmarks: Landmark[]): void {
    const known = landmarks.map(({ id }) => this.source.getFeatureById(id)).filter((feature) => feature !== null);
    this.source.removeFeatures(known);
    this.source.addFeatures(landmarks.map(featureOf));
    this.drawn = null;
  }

  clear(): void {
    this.source.clear(true);
    this.drawn = null;
  }

  /** Returns the nearest landmark at a place, if any. @param resolution metres per pixel */
  at([x = 0, y = 0]: number[], resolution: number): Landmark | null {
    if (!this.layer.isVisible()) return null;
    const reach = kHitPx * resolution;
    const around = this.source.getFeaturesInExtent([x - reach, y - reach, x + reach, y + reach]);
    const distance = ({ at }: Landmark): number => Math.hypot(at[0] - x, at[1] - y);
    return around
      .map((feature) => feature.get('landmark') as Landmark)
      .filter(({ id }) => this.isDrawn(id, resolution))
      .reduce<Landmark | null>((best, each) => (best && distance(best) <= distance(each) ? best : each), null);
  }

  setTheme(theme: Theme): void {
    const near = stylesOf(theme);
    const far = dotOf(theme);
    this.layer.setStyle((feature, resolution) => {
      if (!this.isDrawn(feature.getId() as number, resolution)) return [];
      return resolution <= kNear ? near[feature.get('role') as Role] : far;
    });
  }

  /** @param resolution metres per pixel */
  private isDrawn(id: number, resolution: number): boolean {
    // Powers of two: a small change of zoom does not change the selection.
    const side = kSpacingPx * 2 ** Math.floor(Math.log2(resolution));
    if (!this.drawn || side !== this.drawnSide) this.choose(side, resolution <= kNear ? 1 : 2);
    return this.drawn?.has(id) ?? false;
  }

  /** @param seenMin landmarks with fewer observations are not drawn */
  private choose(side: number, seenMin: number): void {
    const landmarks = this.source.getFeatures().map((feature) => feature.get('landmark') as Landmark);
    const wanted = landmarks.filter(({ seen }) => seen >= seenMin);
    this.drawn = thin(
      wanted.map(({ id, at, seen }) => ({ id, at, weight: seen })),
      side,
    );
    this.drawnSide = side;
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
  const shape = (points: number, radius: number, fill: string, stroke: string): Style =>
    new Style({
      image: new RegularShape({
        points,
        radius,
        fill: new Fill({ color: fill }),
        stroke: new Stroke({ color: stroke, width: 1.5 }),
      }),
    });
  return {
    once: shape(3, 5, halo, landmark),
    again: shape(4, 6, landmark, halo),
  };
}
