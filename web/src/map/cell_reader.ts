/** The value of single cells, read from the native tiles as the person points at them. */
import { fetchTileCells, type SessionKey } from '../api/api';
import { kNativeZoom, kTileSize, placeOfCell, type Cell } from './grid';
import { tileKey, type TileVersions } from './versions';

const kTilesMax = 16;
const kUnknownValue = 255;

export type CellValue = { kind: 'percent'; percent: number } | { kind: 'unknown' } | { kind: 'loading' };

interface TileCells {
  revision: number;
  values: Uint8Array | null;
  loading: boolean;
}

export class CellReader {
  /** Least recently used first. */
  private readonly tiles = new Map<string, TileCells>();

  constructor(
    private readonly session: SessionKey,
    private readonly versions: TileVersions,
    private readonly signal: AbortSignal,
    /** Called when read() would answer better than before. */
    private readonly arrived: () => void,
  ) {}

  /** Answers from what is at hand, and asks for a newer version of the tile if there is one. */
  read(cell: Cell): CellValue {
    const place = placeOfCell(cell);
    const revision = place ? this.versions.get(kNativeZoom, place.x, place.y) : undefined;
    if (!place || revision === undefined) return { kind: 'unknown' };
    const tile = this.tileAt(place.x, place.y);
    if (tile.revision < revision && !tile.loading) void this.load(tile, place.x, place.y, revision);
    if (!tile.values) return { kind: 'loading' };
    const value = tile.values[place.row * kTileSize + place.column] ?? kUnknownValue;
    return value === kUnknownValue ? { kind: 'unknown' } : { kind: 'percent', percent: value };
  }

  private tileAt(x: number, y: number): TileCells {
    const key = tileKey(kNativeZoom, x, y);
    const tile = this.tiles.get(key) ?? { revision: -1, values: null, loading: false };
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
      tile.values = await fetchTileCells(this.session, { z: kNativeZoom, x, y, revision }, this.signal);
      tile.revision = revision;
    } catch {
      // The connection's state is told elsewhere; the next look at this cell asks again.
      return;
    } finally {
      tile.loading = false;
    }
    this.arrived();
  }
}
