/** A way over all ground of a region, and the ground that it leaves out, hatched. */
import Feature from 'ol/Feature';
import LineString from 'ol/geom/LineString';
import MultiPolygon from 'ol/geom/MultiPolygon';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import Fill from 'ol/style/Fill';
import Stroke from 'ol/style/Stroke';
import Style from 'ol/style/Style';
import type { Coverage } from '../api/coverage';
import { kOrder } from '../map/order';
import type { ToolContext } from './context';

const kHatchPx = 8;

export class CoverageLayer {
  private readonly way = new Feature<LineString>();
  private readonly rest = new Feature<MultiPolygon>();

  constructor({ map, theme }: ToolContext, signal: AbortSignal) {
    const layer = new VectorLayer({
      source: new VectorSource({ features: [this.rest, this.way] }),
      style: (feature) => (feature === this.way ? wayStyles(theme().way, theme().halo) : restStyle(theme().warn)),
      zIndex: kOrder.ways,
    });
    map.addLayer(layer);
    signal.addEventListener('abort', () => map.removeLayer(layer));
  }

  /** Null: nothing. */
  show(coverage: Coverage | null): void {
    this.way.setGeometry(coverage ? new LineString(coverage.points) : undefined);
    this.rest.setGeometry(coverage ? new MultiPolygon(coverage.unreachable) : undefined);
  }
}

function wayStyles(colour: string, halo: string): Style[] {
  return [
    new Style({ stroke: new Stroke({ color: halo, width: 3.5, lineJoin: 'round' }) }),
    new Style({ stroke: new Stroke({ color: colour, width: 1.5, lineJoin: 'round' }) }),
  ];
}

function restStyle(colour: string): Style {
  return new Style({
    fill: new Fill({ color: hatched(colour) }),
    stroke: new Stroke({ color: colour, width: 1.5 }),
  });
}

/** Slanting lines. */
function hatched(colour: string): CanvasPattern | string {
  const tile = document.createElement('canvas');
  tile.width = tile.height = kHatchPx;
  const context = tile.getContext('2d');
  if (!context) return colour;
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  for (const shift of [-kHatchPx, 0, kHatchPx]) {
    context.moveTo(shift, kHatchPx);
    context.lineTo(shift + kHatchPx, 0);
  }
  context.stroke();
  return context.createPattern(tile, 'repeat') ?? colour;
}
