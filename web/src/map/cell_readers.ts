/** Readers of cells, one for each layer of the maps that are shown. */
import { kLayers, type LayerName } from '../layers/layers';
import { CellReader } from './cell_reader';
import type { MapSource } from './map_source';

/** Number of maps that are kept: two sides, and one to return to. */
const kSourcesMax = 3;

export class CellReaders {
  /** Least recently used first. */
  private readonly bySource = new Map<MapSource, Map<LayerName, CellReader>>();

  constructor(
    private readonly signal: AbortSignal,
    /** Called when a reader would return a newer value. */
    private readonly arrived: () => void,
  ) {}

  of(source: MapSource, layer: LayerName): CellReader {
    const readers = this.bySource.get(source) ?? new Map<LayerName, CellReader>();
    this.bySource.delete(source);
    this.bySource.set(source, readers);
    for (const oldest of this.bySource.keys()) if (this.bySource.size > kSourcesMax) this.bySource.delete(oldest);
    const reader = readers.get(layer) ?? new CellReader(source, layer, this.signal, this.arrived);
    readers.set(layer, reader);
    return reader;
  }

  /** Values of all layers that are known there, the shown one first. */
  all(source: MapSource, shown: LayerName): CellReader[] {
    return [shown, ...kLayers.filter((layer) => layer !== shown)].map((layer) => this.of(source, layer));
  }
}
