/** Measures distances on the map: the length of a line through the places that the user picks. */
import Feature from 'ol/Feature';
import LineString from 'ol/geom/LineString';
import VectorLayer from 'ol/layer/Vector';
import type OlMap from 'ol/Map';
import VectorSource from 'ol/source/Vector';
import { el, setText } from '../dom';
import * as format from '../format';
import { kOrder } from '../map/order';
import { pickSentence } from '../pointing';
import type { Theme } from '../theme';
import { pathStyle } from './path_style';
import { pickPlaces } from './pick_places';
import type { Tool } from './toolbox';

export function measureTool(map: OlMap, target: HTMLElement, theme: () => Theme): Tool {
  return {
    id: 'measure',
    title: 'Measure',
    key: 'm',
    does: 'measures a distance',
    icon: 'M2 11 11 2l3 3-9 9zM5 8l1.5 1.5M7 6l1.5 1.5M9 4l1.5 1.5',
    open: (card, signal) => open(map, target, theme, card, signal),
  };
}

function open(map: OlMap, target: HTMLElement, theme: () => Theme, card: HTMLElement, signal: AbortSignal): void {
  const line = new LineString([]);
  const layer = new VectorLayer({
    source: new VectorSource({ features: [new Feature(line)] }),
    style: (feature) => pathStyle(feature, theme().accent, theme().halo),
    zIndex: kOrder.marks,
  });
  map.addLayer(layer);
  const sum = el('output', { id: 'measured', class: 'numeric figure' });
  const again = el('button', { type: 'button' }, 'Start again');
  card.append(el('p', {}, pickSentence('the places to measure between')), sum, again);
  const show = (): void => setText(sum, line.getCoordinates().length < 2 ? '' : format.distance(line.getLength()));
  again.addEventListener('click', () => {
    line.setCoordinates([]);
    show();
  });
  pickPlaces(map, target, signal, (place) => {
    line.appendCoordinate(place);
    show();
  });
  signal.addEventListener('abort', () => map.removeLayer(layer));
}
