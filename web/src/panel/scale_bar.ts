/** The scale bar. */
import type OlMap from 'ol/Map';
import { setText } from '../dom';
import * as format from '../format';
import { scaleStep } from '../map/scale';

const kPixelsMax = 120;

export function showScale(map: OlMap, bar: HTMLElement): void {
  map.on('postrender', () => {
    const resolution = map.getView().getResolution();
    if (!resolution) return;
    const { metres, pixels } = scaleStep(resolution, kPixelsMax);
    bar.style.width = `${pixels}px`;
    setText(bar, format.roundLength(metres));
  });
}
