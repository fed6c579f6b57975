/** Draws a coverage path, and the ground that it does not reach, hatched. */
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
  private readonly path = new Feature<LineString>();
  private readonly rest = new Feature<MultiPolygon>();

  constructor({ map, theme }: ToolContext, signal: AbortSignal) {
    const layer = new VectorLayer({
      source: new VectorSource({ features: [this.rest, this.path] }),
      style: (feature) => (feature === this.path ? pathStyles(theme().path, theme().halo) : restStyle(theme().warn)),
      zIndex: kOrder.paths,
    });
    map.addLayer(layer);
    signal.addEventListener('abort', () => map.removeLayer(layer));
  }

  /** Null: draws nothing. */
  show(coverage: Coverage | null): void {
    this.path.setGeometry(coverage ? new LineString(coverage.points) : undefined);
    this.rest.setGeometry(coverage ? new MultiPolygon(coverage.unreachable) : undefined);
  }
}

function pathStyles(colour: string, halo: string): Style[] {
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

/** Diagonal lines. */
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
