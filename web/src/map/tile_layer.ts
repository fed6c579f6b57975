/** The occupancy layer: tiles that are replaced one by one as the map grows, without a blank frame in between. */
import TileLayer from 'ol/layer/Tile';
import type Projection from 'ol/proj/Projection';
import ImageTileSource from 'ol/source/ImageTile';
import TileGrid from 'ol/tilegrid/TileGrid';
import type { Session, TileChange } from '../api/types';
import { squareExtent, tileResolutions } from './grid';
import type { Palette } from './palette';
import { TileImages } from './tile_images';
import type { TileVersions } from './versions';

/** A tile that the server keeps refusing is not asked for more often than this. */
const kRetryMs = 3_000;

export class LiveTiles {
  readonly layer: TileLayer<ImageTileSource>;
  private readonly source: CellSource;
  private readonly images: TileImages;
  private generation = 0;
  private outdated = false;
  private retriedAt = -Infinity;

  constructor(
    session: Session,
    private readonly versions: TileVersions,
    projection: Projection,
    viewResolution: () => number,
    palette: Palette,
    signal: AbortSignal,
  ) {
    this.images = new TileImages(session, versions, palette, signal, () => this.renewIfIdle());
    this.source = new CellSource(session.cellSize, viewResolution, projection, this.images);
    this.layer = new TileLayer({ source: this.source });
  }

  apply(tiles: TileChange[]): void {
    this.versions.apply(tiles);
    this.outdated = true;
    this.renewIfIdle();
  }

  /** Tiles that could not be had are asked for again. */
  retry(): void {
    const now = performance.now();
    if (now - this.retriedAt < kRetryMs || !this.images.takeFailure()) return;
    this.retriedAt = now;
    this.outdated = true;
    this.renewIfIdle();
  }

  setPalette(palette: Palette): void {
    this.images.setPalette(palette);
    this.outdated = true;
    this.renewIfIdle();
  }

  /**
   * A new key makes OpenLayers load every visible tile anew while it still draws the old ones. Waiting until the last
   * round is through keeps a slow link from starting loads faster than they end.
   */
  private renewIfIdle(): void {
    if (!this.outdated || this.images.busy) return;
    this.outdated = false;
    this.generation += 1;
    this.source.renew(`g${this.generation}`);
  }
}

class CellSource extends ImageTileSource {
  constructor(
    private readonly cellSize: number,
    private readonly viewResolution: () => number,
    projection: Projection,
    images: TileImages,
  ) {
    super({
      loader: (z, x, y) => images.load(z, x, y),
      projection,
      tileGrid: new TileGrid({ extent: squareExtent(cellSize), resolutions: tileResolutions(cellSize) }),
      wrapX: false,
      interpolate: false,
      transition: 0,
    });
  }

  renew(key: string): void {
    this.setKey(key);
  }

  /** Cells larger than a pixel have sharp edges; smaller ones are averaged, lest thin walls vanish between pixels. */
  override getInterpolate(): boolean {
    return this.viewResolution() > this.cellSize * window.devicePixelRatio;
  }
}
