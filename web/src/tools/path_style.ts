/** Style of a line, or an outline, with its corners on the map. */
import type { FeatureLike } from 'ol/Feature';
import LineString from 'ol/geom/LineString';
import MultiPoint from 'ol/geom/MultiPoint';
import Polygon from 'ol/geom/Polygon';
import Circle from 'ol/style/Circle';
import Fill from 'ol/style/Fill';
import Stroke from 'ol/style/Stroke';
import Style from 'ol/style/Style';

export function pathStyle(feature: FeatureLike, colour: string, halo: string): Style[] {
  const corners = (): MultiPoint => {
    const geometry = feature.getGeometry();
    if (geometry instanceof Polygon) return new MultiPoint(geometry.getCoordinates()[0] ?? []);
    return new MultiPoint(geometry instanceof LineString ? geometry.getCoordinates() : []);
  };
  return [
    new Style({ stroke: new Stroke({ color: halo, width: 5, lineJoin: 'round' }) }),
    new Style({ stroke: new Stroke({ color: colour, width: 2.5, lineJoin: 'round' }) }),
    new Style({
      geometry: corners,
      image: new Circle({
        radius: 4,
        fill: new Fill({ color: halo }),
        stroke: new Stroke({ color: colour, width: 2 }),
      }),
    }),
  ];
}
