/**
 * Shows one layer of cells; a new layer replaces the shown one when it has loaded, not before. Of newer layers meanwhile
 * only the last is kept.
 */
import type OlMap from 'ol/Map';
import type RenderEvent from 'ol/render/Event';
import type { LayerName } from '../layers/layers';
import type { Palette } from '../layers/palette';
import { clipTo, type Clip } from './clip';
import type { MapSource } from './map_source';
import type { Shown } from './map_view';
import { kProjection } from './projection';
import { CellLayer } from './tile_layer';

interface Hung {
  layer: CellLayer;
  leave: AbortController;
}

export class CellPane {
  private now: Hung | null = null;
  private before: Hung | null = null;
  /** Follows when `now` has loaded; null: nothing waits. */
  private next: Shown | null = null;
  private opacity = 1;
  private clip: Clip = { from: 0, to: 1 };

  constructor(
    private readonly map: OlMap,
    private readonly zIndex: number,
    private palette: Palette,
    /** Called with the outcome of each tile request: null, or the error. */
    private readonly settledTile: (error: unknown) => void,
  ) {}

  show(source: MapSource, layer: LayerName): void {
    this.next = null;
    if (this.now?.layer.suits(source, layer)) this.now.layer.retarget(source);
    else if (this.before) this.next = { source, layer };
    else this.replace(source, layer);
  }

  clear(): void {
    for (const hung of [this.before, this.now]) if (hung) this.takeDown(hung);
    this.before = this.now = this.next = null;
  }

  /** Called when the maps have changed. */
  renew(): void {
    this.now?.layer.renew();
  }

  setPalette(palette: Palette): void {
    this.palette = palette;
    this.now?.layer.setPalette(palette);
  }

  setOpacity(opacity: number): void {
    this.opacity = opacity;
    this.now?.layer.tiles.setOpacity(opacity);
  }

  setClip(clip: Clip): void {
    this.clip = clip;
    this.map.render();
  }

  private replace(source: MapSource, layer: LayerName): void {
    this.before = this.now;
    const leave = new AbortController();
    const hung: Hung = {
      leave,
      layer: new CellLayer(source, layer, {
        projection: kProjection,
        viewResolution: () => this.map.getView().getResolution() ?? 0,
        palette: this.palette,
        signal: leave.signal,
        idle: () => this.settled(hung),
        settled: this.settledTile,
      }),
    };
    this.now = hung;
    const { tiles } = hung.layer;
    tiles.setZIndex(this.zIndex);
    tiles.setOpacity(this.opacity);
    tiles.on('prerender', (event) => this.beginClip(event));
    tiles.on('postrender', ({ context }) => (context as CanvasRenderingContext2D).restore());
    this.map.addLayer(tiles);
    this.map.once('rendercomplete', () => this.settled(hung));
  }

  private settled(hung: Hung): void {
    if (hung !== this.now || !this.before) return;
    this.takeDown(this.before);
    this.before = null;
    const { next } = this;
    if (next) this.show(next.source, next.layer);
  }

  private takeDown({ layer, leave }: Hung): void {
    leave.abort();
    this.map.removeLayer(layer.tiles);
  }

  private beginClip({ context }: RenderEvent): void {
    const canvas = context as CanvasRenderingContext2D;
    canvas.save();
    clipTo(canvas, this.clip);
  }
}
