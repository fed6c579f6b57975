/** Coloured tiles: each has its own canvas, which is repainted in place when the tile changes. */
import { fetchTileImage } from '../api/api';
import type { LayerName } from '../layers/layers';
import { colourise, colourTable, type ColourTable, type Palette } from '../layers/palette';
import { kTileSize } from './grid';
import type { MapSource } from './map_source';
import { tileKey } from './versions';

/** About 100 MB of pixels: several screens, so that zooming in and out again requests nothing. */
export const kImagesMax = 384;

/** Minimum time before a refused tile is requested again. */
export const kRetryMs = 3_000;

/** The revision of tiles without data. */
const kUntouched = -1;

/** Tiles of one zoom: columns and rows, both ends included. */
export interface TileRange {
  z: number;
  minX: number;
  maxX: number;
  minY: number;
  maxY: number;
}

interface TileImage {
  z: number;
  x: number;
  y: number;
  /** One pixel while there is nothing to show. */
  canvas: HTMLCanvasElement;
  /** The painted version; null: none yet. */
  painted: number | null;
  loading: Promise<void> | null;
  /** Time of the last failure, by performance.now(). */
  failedAt: number;
}

export interface TileImagesEvents {
  /** A canvas was painted and needs drawing. */
  painted(): void;
  /** No requests are pending. */
  idle(): void;
  /** A tile request failed and is repeated after kRetryMs; null: one succeeded. */
  settled(error: unknown): void;
}

export class TileImages {
  private readonly images = new Map<string, TileImage>();
  private table: ColourTable;
  private loading = 0;

  constructor(
    private source: MapSource,
    private readonly layer: LayerName,
    palette: Palette,
    private readonly signal: AbortSignal,
    private readonly events: TileImagesEvents,
  ) {
    this.table = colourTable(layer, palette);
  }

  /** Switches to other maps of the same family: tiles with the same version stay valid. */
  retarget(source: MapSource): void {
    this.source = source;
  }

  get busy(): boolean {
    return this.loading > 0;
  }

  get size(): number {
    return this.images.size;
  }

  /** Invalidates all tiles. */
  clear(): void {
    this.images.clear();
  }

  setPalette(palette: Palette): void {
    this.table = colourTable(this.layer, palette);
    this.clear();
  }

  /**
   * A tile without data is blank and causes no request. A tile that cannot be loaded is blank until a request succeeds.
   */
  async load(z: number, x: number, y: number): Promise<HTMLCanvasElement> {
    const key = tileKey(z, x, y);
    let image = this.images.get(key);
    if (!image) {
      image = { z, x, y, canvas: newCanvas(), painted: null, loading: null, failedAt: -Infinity };
      this.images.set(key, image);
    }
    this.update(image);
    if (image.painted === null) await image.loading;
    return image.canvas;
  }

  /** Requests the changed ones of these tiles, and paints them when they arrive. */
  refresh({ z, minX, maxX, minY, maxY }: TileRange): void {
    for (let x = minX; x <= maxX; ++x) {
      for (let y = minY; y <= maxY; ++y) {
        const image = this.images.get(tileKey(z, x, y));
        if (image) this.update(image);
      }
    }
  }

  private update(image: TileImage): void {
    if (image.loading || image.painted === this.wanted(image)) return;
    if (performance.now() - image.failedAt < kRetryMs) return;
    this.loading += 1;
    image.loading = this.fetch(image);
  }

  private async fetch(image: TileImage): Promise<void> {
    try {
      await this.bringUpToDate(image);
      this.events.settled(null);
    } catch (error) {
      image.failedAt = performance.now();
      if (!this.signal.aborted) this.events.settled(error);
    } finally {
      image.loading = null;
      this.loading -= 1;
      if (this.loading === 0) this.events.idle();
    }
  }

  private async bringUpToDate(image: TileImage): Promise<void> {
    for (let revision = this.wanted(image); revision !== image.painted; revision = this.wanted(image)) {
      if (revision === kUntouched) {
        image.canvas.width = image.canvas.height = 1;
      } else {
        const { session, weave } = this.source;
        const { z, x, y } = image;
        const bitmap = await fetchTileImage({ session, weave, layer: this.layer }, { z, x, y, revision }, this.signal);
        paint(bitmap, this.table, image.canvas);
      }
      image.painted = revision;
      this.events.painted();
    }
  }

  private wanted({ z, x, y }: TileImage): number {
    return this.source.versions(this.layer).get(z, x, y) ?? kUntouched;
  }
}

/** Pixels are recoloured here, in memory, before they are copied to the canvas. */
const kWorkbench = newCanvas(kTileSize).getContext('2d', { willReadFrequently: true });

function paint(bitmap: ImageBitmap, table: ColourTable, canvas: HTMLCanvasElement): void {
  if (canvas.width !== kTileSize) canvas.width = canvas.height = kTileSize;
  const context = canvas.getContext('2d');
  if (!context || !kWorkbench) throw new Error('this browser gives no canvas to draw on');
  kWorkbench.clearRect(0, 0, kTileSize, kTileSize);
  kWorkbench.drawImage(bitmap, 0, 0);
  bitmap.close();
  const image = kWorkbench.getImageData(0, 0, kTileSize, kTileSize);
  colourise(image.data, table);
  context.putImageData(image, 0, 0);
}

function newCanvas(side = 1): HTMLCanvasElement {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = side;
  return canvas;
}
