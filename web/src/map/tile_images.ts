/** Coloured tiles, fetched once per version. */
import { fetchTileImage, type SessionKey } from '../api/api';
import { kTileSize } from './grid';
import { colourise, colourTable, type Palette } from './palette';
import { tileKey, type TileVersions } from './versions';

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
  private table: Uint32Array;
  private underWay = 0;
  private failed = false;

  constructor(
    private readonly session: SessionKey,
    private readonly versions: TileVersions,
    palette: Palette,
    private readonly signal: AbortSignal,
    /** Called when nothing is under way any more. */
    private readonly idle: () => void,
  ) {
    this.table = colourTable(palette);
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
    this.table = colourTable(palette);
    this.images.clear();
  }

  /** The newest version known of; a tile that was never touched is blank and asks nothing of the server. */
  load(z: number, x: number, y: number): Promise<HTMLCanvasElement> {
    const revision = this.versions.get(z, x, y);
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
      const bitmap = await fetchTileImage(this.session, { z, x, y, revision }, this.signal);
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
