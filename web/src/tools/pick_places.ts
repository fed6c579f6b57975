/** Places that the user picks on the map: with the pointer, or with the crosshair of the keyboard and Enter. */
import DoubleClickZoom from 'ol/interaction/DoubleClickZoom';
import type OlMap from 'ol/Map';
import type { Point } from '../api/types';
import { byId } from '../dom';

/**
 * @param target the map's element
 * @param picked called for each place, metres, until the signal aborts
 */
export function pickPlaces(map: OlMap, target: HTMLElement, signal: AbortSignal, picked: (place: Point) => void): void {
  const click = ({ coordinate }: { coordinate: number[] }): void => picked([coordinate[0] ?? 0, coordinate[1] ?? 0]);
  const press = (event: KeyboardEvent): void => {
    const centre = map.getView().getCenter();
    if (event.key !== 'Enter' || event.target !== target || !centre) return;
    // The first key after using the pointer only shows the crosshair.
    if (byId('crosshair', HTMLElement).hidden) return;
    event.preventDefault();
    picked([centre[0] ?? 0, centre[1] ?? 0]);
  };
  // Two places picked in quick succession must not zoom in.
  const zooms = map
    .getInteractions()
    .getArray()
    .filter((each) => each instanceof DoubleClickZoom);
  for (const zoom of zooms) zoom.setActive(false);
  map.on('click', click);
  target.addEventListener('keydown', press, { signal, capture: true });
  target.classList.add('picking');
  signal.addEventListener('abort', () => {
    for (const zoom of zooms) zoom.setActive(true);
    map.un('click', click);
    target.classList.remove('picking');
  });
}
