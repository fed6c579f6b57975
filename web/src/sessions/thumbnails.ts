/** Thumbnails of the sessions' maps: loads only visible and changed ones, and only a few at a time. */
import { fetchChanges, fetchTileImage } from '../api/api';
import type { Bounds, Session } from '../api/types';
import type { LayerName } from '../layers/layers';
import { colourise, colourTable, type Palette } from '../layers/palette';
import { TileVersions } from '../map/versions';
import { planThumbnail, type ThumbnailPlan } from './thumbnail_plan';

/** Size in the row, CSS pixels; equal to the size in the style sheet. */
const kWidth = 56;
const kHeight = 40;
/** Minimum time between two loads of a thumbnail, also after a failure. */
const kPaceMs = 10_000;
const kAtOnce = 2;
/** The server's colour of unknown cells. */
const kUnknownColour = '#808080';

interface Thumbnail {
  session: Session;
  inView: boolean;
  /** Identity and revision of the shown picture; null: none. */
  shown: string | null;
  triedAt: number;
  loading: boolean;
  tiles: KnownTiles;
}

/** The known tile versions of a session: only changed tiles are requested; the browser caches the others. */
interface KnownTiles {
  /** The session's revision. */
  id: string;
  byLayer: Map<LayerName, { revision: number; versions: TileVersions }>;
}

export class Thumbnails {
  private readonly all = new Map<Element, Thumbnail>();
  private readonly observer = new IntersectionObserver((entries) => this.look(entries));
  private table: Uint32Array;
  private loading = 0;

  constructor(palette: Palette) {
    this.table = colourTable('occupancy', palette);
  }

  /** Shows this session on the canvas as soon as the canvas is visible. */
  show(canvas: HTMLCanvasElement, session: Session): void {
    const known = this.all.get(canvas);
    if (known) {
      known.session = session;
    } else {
      const tiles = { id: session.id, byLayer: new Map() };
      this.all.set(canvas, { session, inView: false, shown: null, triedAt: -Infinity, loading: false, tiles });
      this.observer.observe(canvas);
    }
    const state = session.bounds === null ? 'empty' : 'map';
    if (canvas.dataset['state'] !== state) canvas.dataset['state'] = state;
  }

  /** Loads due thumbnails, and forgets canvases that the list has removed. */
  tend(): void {
    for (const canvas of this.all.keys()) {
      if (canvas.isConnected) continue;
      this.observer.unobserve(canvas);
      this.all.delete(canvas);
    }
    this.drawDue();
  }

  setPalette(palette: Palette): void {
    this.table = colourTable('occupancy', palette);
    for (const thumbnail of this.all.values()) {
      thumbnail.shown = null;
      thumbnail.triedAt = -Infinity;
    }
    this.drawDue();
  }

  private look(entries: IntersectionObserverEntry[]): void {
    for (const { target, isIntersecting } of entries) {
      const thumbnail = this.all.get(target);
      if (thumbnail) thumbnail.inView = isIntersecting;
    }
    this.drawDue();
  }

  private drawDue(): void {
    if (document.hidden) return;
    for (const [canvas, thumbnail] of this.all) {
      if (this.loading >= kAtOnce) return;
      if (canvas instanceof HTMLCanvasElement && isDue(thumbnail)) void this.draw(canvas, thumbnail);
    }
  }

  private async draw(canvas: HTMLCanvasElement, thumbnail: Thumbnail): Promise<void> {
    const { session } = thumbnail;
    if (!session.bounds) return;
    const { table } = this;
    thumbnail.loading = true;
    thumbnail.triedAt = performance.now();
    this.loading += 1;
    try {
      if (thumbnail.tiles.id !== session.id) thumbnail.tiles = { id: session.id, byLayer: new Map() };
      const picture = await compose(session, session.mainBounds ?? session.bounds, thumbnail.tiles, table);
      // The old picture stays until the new one is loaded, also after a failure.
      paint(canvas, picture);
      if (table === this.table) thumbnail.shown = versionOf(session);
    } catch {
      // A thumbnail is decoration: other parts of the page report connection errors; the next check tries again.
    } finally {
      thumbnail.loading = false;
      this.loading -= 1;
      this.drawDue();
    }
  }
}

function isDue({ session, inView, shown, triedAt, loading }: Thumbnail): boolean {
  if (!inView || loading || session.bounds === null || shown === versionOf(session)) return false;
  return performance.now() - triedAt >= kPaceMs;
}

function versionOf({ id, revision }: Session): string {
  return `${id} ${revision}`;
}

/** Returns the layer to show: occupancy, or sonar where lasers have observed nothing. */
async function compose(
  session: Session,
  bounds: Bounds,
  tiles: KnownTiles,
  table: Uint32Array,
): Promise<HTMLCanvasElement> {
  const plan = planThumbnail(bounds, session.cellSize);
  for (const layer of ['occupancy', 'sonar'] as const) {
    const versions = await versionsOf(session, layer, tiles);
    if (plan.tiles.some(({ z, x, y }) => versions.get(z, x, y) !== undefined)) {
      return composeLayer(session, layer, plan, versions, table);
    }
  }
  return document.createElement('canvas');
}

/** Fetches the changes since the last request. */
async function versionsOf(session: Session, layer: LayerName, { byLayer }: KnownTiles): Promise<TileVersions> {
  const known = byLayer.get(layer) ?? { revision: 0, versions: new TileVersions() };
  byLayer.set(layer, known);
  const { signal } = new AbortController();
  const changes = await fetchChanges(session.name, { layer, since: known.revision, weave: null }, signal);
  known.versions.apply(changes.tiles);
  known.revision = changes.revision;
  return known.versions;
}

/** Uses the page's colours and the pixels of the tiles. */
async function composeLayer(
  session: Session,
  layer: LayerName,
  plan: ThumbnailPlan,
  versions: TileVersions,
  table: Uint32Array,
): Promise<HTMLCanvasElement> {
  const canvas = document.createElement('canvas');
  canvas.width = plan.width;
  canvas.height = plan.height;
  const context = contextOf(canvas);
  context.fillStyle = kUnknownColour;
  context.fillRect(0, 0, plan.width, plan.height);
  const { signal } = new AbortController();
  const load = async ({ z, x, y, left, top }: ThumbnailPlan['tiles'][number]): Promise<void> => {
    const revision = versions.get(z, x, y);
    if (revision === undefined) return;
    const bitmap = await fetchTileImage({ session, layer, weave: null }, { z, x, y, revision }, signal);
    context.drawImage(bitmap, left, top);
    bitmap.close();
  };
  await Promise.all(plan.tiles.map(load));
  const image = context.getImageData(0, 0, plan.width, plan.height);
  colourise(image.data, table);
  context.putImageData(image, 0, 0);
  return canvas;
}

/** Fits the picture to the canvas, centred; enlarged cells keep sharp edges. */
function paint(canvas: HTMLCanvasElement, picture: HTMLCanvasElement): void {
  const density = window.devicePixelRatio;
  canvas.width = Math.round(kWidth * density);
  canvas.height = Math.round(kHeight * density);
  const context = contextOf(canvas);
  const scale = Math.min(canvas.width / picture.width, canvas.height / picture.height);
  const width = Math.max(1, Math.round(picture.width * scale));
  const height = Math.max(1, Math.round(picture.height * scale));
  context.imageSmoothingEnabled = scale < 1;
  context.imageSmoothingQuality = 'high';
  const left = Math.round((canvas.width - width) / 2);
  const top = Math.round((canvas.height - height) / 2);
  context.drawImage(picture, left, top, width, height);
}

function contextOf(canvas: HTMLCanvasElement): CanvasRenderingContext2D {
  const context = canvas.getContext('2d', { willReadFrequently: true });
  if (!context) throw new Error('this browser gives no canvas to draw on');
  return context;
}
