/** Coloured tiles: each is a canvas of its own, painted anew in place when its tile has changed. */
import { fetchTileImage } from '../api/api';
import type { LayerName } from '../layers/layers';
import { colourise, colourTable, type ColourTable, type Palette } from '../layers/palette';
import { kTileSize } from './grid';
import type { MapSource } from './map_source';
import { tileKey } from './versions';

/** About 100 MB of pixels: several screens full, so that a change of zoom and back asks for nothing. */
export const kImagesMax = 384;

/** A tile that the server refuses is not asked for more often than this. */
export const kRetryMs = 3_000;

/** The revision of what nothing ever touched. */
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
  /** One pixel as long as there is nothing to show. */
  canvas: HTMLCanvasElement;
  /** What it shows; null: nothing yet. */
  painted: number | null;
  loading: Promise<void> | null;
  /** When it could not be had, by performance.now(). */
  failedAt: number;
}

export interface TileImagesEvents {
  /** A canvas was painted: it is to be drawn. */
  painted(): void;
  /** Nothing is under way any more. */
  idle(): void;
  /** A tile could not be had, and is asked for again after kRetryMs; null: one could. */
  settled(error: unknown): void;
}

export class TileImages {
  private readonly images = new Map<string, TileImage>();
  private table: ColourTable;
  private underWay = 0;

  constructor(
    private source: MapSource,
    private readonly layer: LayerName,
    palette: Palette,
    private readonly signal: AbortSignal,
    private readonly events: TileImagesEvents,
  ) {
    this.table = colourTable(layer, palette);
  }

  /** Other maps of the same family: what is painted of the same version stays good. */
  retarget(source: MapSource): void {
    this.source = source;
  }

  get busy(): boolean {
    return this.underWay > 0;
  }

  get size(): number {
    return this.images.size;
  }

  /** All are asked for anew. */
  clear(): void {
    this.images.clear();
  }

  setPalette(palette: Palette): void {
    this.table = colourTable(this.layer, palette);
    this.clear();
  }

  /**
   * A tile that was never touched is blank and asks nothing of the server; so is, for the time being, one that cannot be
   * had: it is painted when it can.
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

  /** Those of these tiles that have changed are asked for, and painted when they are there. */
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
    this.underWay += 1;
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
      this.underWay -= 1;
      if (this.underWay === 0) this.events.idle();
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

/** Pixels are recoloured here, in memory, before they go to where they are drawn from. */
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
