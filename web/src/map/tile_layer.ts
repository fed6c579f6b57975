/** A layer of cells: its tiles are repainted one by one as the map grows, without a blank frame. */
import TileLayer from 'ol/layer/Tile';
import type Projection from 'ol/proj/Projection';
import type RenderEvent from 'ol/render/Event';
import ImageTileSource from 'ol/source/ImageTile';
import TileGrid from 'ol/tilegrid/TileGrid';
import type { LayerName } from '../layers/layers';
import type { Palette } from '../layers/palette';
import { squareExtent, tileResolutions } from './grid';
import type { MapSource } from './map_source';
import { kImagesMax, kRetryMs, TileImages } from './tile_images';

export interface CellLayerOptions {
  projection: Projection;
  /** Metres per pixel of the current view. */
  viewResolution: () => number;
  palette: Palette;
  signal: AbortSignal;
  /** Called when all requests have finished. */
  idle: () => void;
  /** Called with the outcome of each tile request: null, or the error. */
  settled: (error: unknown) => void;
}

export class CellLayer {
  readonly tiles: TileLayer<ImageTileSource>;
  private readonly cells: CellTiles;
  private readonly images: TileImages;
  private generation = 0;
  private retry = 0;

  constructor(
    private source: MapSource,
    readonly layer: LayerName,
    { palette, signal, viewResolution, projection, idle, settled }: CellLayerOptions,
  ) {
    this.images = new TileImages(source, layer, palette, signal, {
      painted: () => this.renew(),
      idle,
      settled: (error) => {
        settled(error);
        if (error !== null) this.renewLater();
      },
    });
    signal.addEventListener('abort', () => clearTimeout(this.retry));
    this.cells = new CellTiles(source.cellSize, viewResolution, projection, this.images);
    this.tiles = new TileLayer({ source: this.cells });
    this.tiles.on('prerender', (event) => this.refresh(event));
    source.need(layer);
  }

  get busy(): boolean {
    return this.images.busy;
  }

  /** Whether these maps can be shown here without a blank frame. */
  suits(source: MapSource, layer: LayerName): boolean {
    const { session, cellSize, family } = this.source;
    const same = session.id === source.session.id && cellSize === source.cellSize && family === source.family;
    return same && layer === this.layer;
  }

  retarget(source: MapSource): void {
    if (source === this.source) return;
    this.source = source;
    this.images.retarget(source);
    source.need(this.layer);
    this.renew();
  }

  /** Called when the maps have changed: the next frame checks all visible tiles. */
  renew(): void {
    this.tiles.changed();
  }

  /** Requests failed tiles again. */
  private renewLater(): void {
    clearTimeout(this.retry);
    this.retry = window.setTimeout(() => this.renew(), kRetryMs);
  }

  setPalette(palette: Palette): void {
    this.images.setPalette(palette);
    this.reload();
  }

  private refresh({ frameState }: RenderEvent): void {
    if (!frameState?.extent) return;
    const grid = this.cells.getTileGrid();
    const z = grid?.getZForResolution(frameState.viewState.resolution, this.cells.zDirection);
    if (!grid || z === undefined) return;
    const { minX, maxX, minY, maxY } = grid.getTileRangeForExtentAndZ(frameState.extent, z);
    this.images.refresh({ z, minX, maxX, minY, maxY });
    if (this.images.size > kImagesMax) this.reload();
  }

  /** A new key makes OpenLayers request every visible tile again while it still draws the old ones. */
  private reload(): void {
    this.images.clear();
    this.generation += 1;
    this.cells.renew(`g${this.generation}`);
  }
}

class CellTiles extends ImageTileSource {
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

  /**
   * Cells larger than a pixel have sharp edges; smaller ones are averaged, so that thin walls do not vanish between
   * pixels.
   */
  override getInterpolate(): boolean {
    return this.viewResolution() > this.cellSize * window.devicePixelRatio;
  }
}
