/** Lettered marks at the places of a tool; they can be dragged. */
import Collection from 'ol/Collection';
import Feature from 'ol/Feature';
import PointGeometry from 'ol/geom/Point';
import Translate from 'ol/interaction/Translate';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import Circle from 'ol/style/Circle';
import Fill from 'ol/style/Fill';
import Stroke from 'ol/style/Stroke';
import Style from 'ol/style/Style';
import Text from 'ol/style/Text';
import type { Point } from '../api/types';
import { kOrder } from '../map/order';
import type { Theme } from '../theme';
import type { ToolContext } from './context';

/** Touch tolerance around a mark, pixels. */
const kReachPx = 10;

export class Marks {
  private readonly features = new Collection<Feature<PointGeometry>>();

  /** @param moved called when a mark was dragged, with its new place in metres */
  constructor({ map, theme }: ToolContext, signal: AbortSignal, moved: (letter: string, place: Point) => void) {
    const source = new VectorSource({ features: this.features });
    const style = (feature: { get(key: string): unknown }): Style => styleOf(String(feature.get('letter')), theme());
    const layer = new VectorLayer({ source, style, zIndex: kOrder.marks });
    const drag = new Translate({ features: this.features, hitTolerance: kReachPx });
    drag.on('translateend', ({ features }) => {
      for (const feature of features.getArray()) {
        const [x = 0, y = 0] = (feature.getGeometry() as PointGeometry).getCoordinates();
        moved(String(feature.get('letter')), [x, y]);
      }
    });
    map.addLayer(layer);
    map.addInteraction(drag);
    signal.addEventListener('abort', () => {
      map.removeInteraction(drag);
      map.removeLayer(layer);
    });
  }

  /** Null: removes the mark. */
  put(letter: string, place: Point | null): void {
    const known = this.features.getArray().find((each) => each.get('letter') === letter);
    if (known && place) known.getGeometry()?.setCoordinates(place);
    else if (known) this.features.remove(known);
    else if (place) this.features.push(new Feature({ geometry: new PointGeometry(place), letter }));
  }
}

function styleOf(letter: string, { accent, halo }: Theme): Style {
  return new Style({
    image: new Circle({
      radius: 10,
      fill: new Fill({ color: accent }),
      stroke: new Stroke({ color: halo, width: 2.5 }),
    }),
    text: new Text({
      text: letter,
      font: '700 12px system-ui, sans-serif',
      fill: new Fill({ color: halo }),
      offsetY: 1,
    }),
  });
}
