/** Coloured tiles, fetched once per version. */
import { fetchTileImage } from '../api/api';
import type { LayerName } from '../layers/layers';
import { colourise, colourTable, type ColourTable, type Palette } from '../layers/palette';
import { kTileSize } from './grid';
import type { MapSource } from './map_source';
import { tileKey } from './versions';

/** About 64 MB of pixels: several screens full, so that a change of zoom and back asks for nothing. */
const kImagesMax = 256;

interface TileImage {
  revision: number;
  canvas: Promise<HTMLCanvasElement>;
}

export class TileImages {
  /** Least recently used first. */
  private readonly images = new Map<string, TileImage>();
  private readonly blank = newCanvas();
  private table: ColourTable;
  private underWay = 0;
  private failed = false;

  constructor(
    private source: MapSource,
    private readonly layer: LayerName,
    palette: Palette,
    private readonly signal: AbortSignal,
    /** Called when nothing is under way any more. */
    private readonly idle: () => void,
  ) {
    this.table = colourTable(layer, palette);
  }

  /** Other maps of the same family: what is at hand of the same version stays good. */
  retarget(source: MapSource): void {
    this.source = source;
  }

  get busy(): boolean {
    return this.underWay > 0;
  }

  /** Whether a tile could not be had since this was asked last. */
  takeFailure(): boolean {
    const failed = this.failed;
    this.failed = false;
    return failed;
  }

  setPalette(palette: Palette): void {
    this.table = colourTable(this.layer, palette);
    this.images.clear();
  }

  /** The newest version known of; a tile that was never touched is blank and asks nothing of the server. */
  load(z: number, x: number, y: number): Promise<HTMLCanvasElement> {
    const revision = this.source.versions(this.layer).get(z, x, y);
    if (revision === undefined) return Promise.resolve(this.blank);
    const key = tileKey(z, x, y);
    const known = this.images.get(key);
    this.images.delete(key);
    const image = known?.revision === revision ? known : { revision, canvas: this.fetch(z, x, y, revision) };
    this.images.set(key, image);
    this.forgetOldest();
    return image.canvas;
  }

  private async fetch(z: number, x: number, y: number, revision: number): Promise<HTMLCanvasElement> {
    this.underWay += 1;
    try {
      const { session, weave } = this.source;
      const bitmap = await fetchTileImage({ session, weave, layer: this.layer }, { z, x, y, revision }, this.signal);
      return paint(bitmap, this.table);
    } catch (error) {
      this.failed = true;
      this.images.delete(tileKey(z, x, y));
      throw error;
    } finally {
      this.underWay -= 1;
      if (this.underWay === 0) this.idle();
    }
  }

  private forgetOldest(): void {
    for (const key of this.images.keys()) {
      if (this.images.size <= kImagesMax) return;
      this.images.delete(key);
    }
  }
}

function paint(bitmap: ImageBitmap, table: Uint32Array): HTMLCanvasElement {
  const canvas = newCanvas();
  const context = canvas.getContext('2d', { willReadFrequently: true });
  if (!context) throw new Error('this browser gives no canvas to draw on');
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  const image = context.getImageData(0, 0, kTileSize, kTileSize);
  colourise(image.data, table);
  context.putImageData(image, 0, 0);
  return canvas;
}

function newCanvas(): HTMLCanvasElement {
  const canvas = document.createElement('canvas');
  canvas.width = kTileSize;
  canvas.height = kTileSize;
  return canvas;
}
