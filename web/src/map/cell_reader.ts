/** Reads the values of single cells from the native tiles under the pointer. */
import { fetchTileCells } from '../api/api';
import { valueOf, type CellValue } from '../layers/cell_value';
import type { LayerName } from '../layers/layers';
import { kNativeZoom, kTileSize, placeOfCell, type Cell } from './grid';
import type { MapSource } from './map_source';
import { tileKey } from './versions';

const kTilesMax = 24;
/** Minimum time between two reads of a tile that changes continually. */
const kAgeMinMs = 500;

/** The code of unknown cells. */
const kNothing: Record<LayerName, number> = { occupancy: 255, himm: 255, sonar: 255, classification: 0 };

interface TileCells {
  revision: number;
  codes: Uint8Array | null;
  loading: boolean;
  loadedAt: number;
}

export class CellReader {
  /** Least recently used first. */
  private readonly tiles = new Map<string, TileCells>();

  constructor(
    private readonly source: MapSource,
    readonly layer: LayerName,
    private readonly signal: AbortSignal,
    /** Called when read() would return a newer value. */
    private readonly arrived: () => void,
  ) {
    source.need(layer);
  }

  /** Metres. */
  get cellSize(): number {
    return this.source.cellSize;
  }

  /** Returns the cached value, and fetches a newer version of the tile if there is one. */
  read(cell: Cell): CellValue {
    const place = placeOfCell(cell);
    const revision = place ? this.source.versions(this.layer).get(kNativeZoom, place.x, place.y) : undefined;
    if (!place || revision === undefined) return valueOf(this.layer, kNothing[this.layer]);
    const tile = this.tileAt(place.x, place.y);
    if (tile.revision < revision) this.renew(tile, place.x, place.y, revision);
    const code = tile.codes?.[place.row * kTileSize + place.column];
    return code === undefined ? { kind: 'loading' } : valueOf(this.layer, code);
  }

  private renew(tile: TileCells, x: number, y: number, revision: number): void {
    if (tile.loading) return;
    const age = performance.now() - tile.loadedAt;
    if (age >= kAgeMinMs) return void this.load(tile, x, y, revision);
    tile.loading = true;
    setTimeout(() => {
      tile.loading = false;
      if (!this.signal.aborted) this.arrived();
    }, kAgeMinMs - age);
  }

  private tileAt(x: number, y: number): TileCells {
    const key = tileKey(kNativeZoom, x, y);
    const tile = this.tiles.get(key) ?? { revision: -1, codes: null, loading: false, loadedAt: -Infinity };
    this.tiles.delete(key);
    this.tiles.set(key, tile);
    for (const oldest of this.tiles.keys()) {
      if (this.tiles.size <= kTilesMax) break;
      this.tiles.delete(oldest);
    }
    return tile;
  }

  private async load(tile: TileCells, x: number, y: number, revision: number): Promise<void> {
    tile.loading = true;
    try {
      const { session, weave } = this.source;
      const place = { z: kNativeZoom, x, y, revision };
      tile.codes = await fetchTileCells({ session, weave, layer: this.layer }, place, this.signal);
      tile.revision = revision;
    } catch {
      // Other parts of the page report connection errors; the next read of this cell tries again.
      return;
    } finally {
      tile.loadedAt = performance.now();
      tile.loading = false;
    }
    this.arrived();
  }
}
