/** Pictures of the sessions' maps: only of those in view, only when they have changed, and only a few at a time. */
import { fetchChanges, fetchTileImage } from '../api/api';
import type { Bounds, Session } from '../api/types';
import type { LayerName } from '../layers/layers';
import { colourise, colourTable, type Palette } from '../layers/palette';
import { TileVersions } from '../map/versions';
import { planThumbnail, type ThumbnailPlan } from './thumbnail_plan';

/** Of the place in the row, CSS pixels; the style sheet gives it the same size. */
const kWidth = 56;
const kHeight = 40;
/** However fast a map grows, and for a picture that cannot be had. */
const kPaceMs = 10_000;
const kAtOnce = 2;
/** What the server draws where nobody has seen anything. */
const kUnknownColour = '#808080';

interface Thumbnail {
  session: Session;
  inView: boolean;
  /** Identity and revision of what is shown; null while nothing is. */
  shown: string | null;
  triedAt: number;
  underWay: boolean;
  tiles: KnownTiles;
}

/** What is known of a session's tiles, so that only those are asked for that have changed: the others are kept by the browser. */
interface KnownTiles {
  /** The session's. */
  id: string;
  byLayer: Map<LayerName, { revision: number; versions: TileVersions }>;
}

export class Thumbnails {
  private readonly all = new Map<Element, Thumbnail>();
  private readonly observer = new IntersectionObserver((entries) => this.look(entries));
  private table: Uint32Array;
  private underWay = 0;

  constructor(palette: Palette) {
    this.table = colourTable('occupancy', palette);
  }

  /** The canvas shows this session from now on, as soon as it is in view. */
  show(canvas: HTMLCanvasElement, session: Session): void {
    const known = this.all.get(canvas);
    if (known) {
      known.session = session;
    } else {
      const tiles = { id: session.id, byLayer: new Map() };
      this.all.set(canvas, { session, inView: false, shown: null, triedAt: -Infinity, underWay: false, tiles });
      this.observer.observe(canvas);
    }
    const state = session.bounds === null ? 'empty' : 'map';
    if (canvas.dataset['state'] !== state) canvas.dataset['state'] = state;
  }

  /** Rows are kept, moved and removed by others: draws what is due, and forgets what is no longer on the page. */
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
      if (this.underWay >= kAtOnce) return;
      if (canvas instanceof HTMLCanvasElement && isDue(thumbnail)) void this.draw(canvas, thumbnail);
    }
  }

  private async draw(canvas: HTMLCanvasElement, thumbnail: Thumbnail): Promise<void> {
    const { session } = thumbnail;
    if (!session.bounds) return;
    const { table } = this;
    thumbnail.underWay = true;
    thumbnail.triedAt = performance.now();
    this.underWay += 1;
    try {
      if (thumbnail.tiles.id !== session.id) thumbnail.tiles = { id: session.id, byLayer: new Map() };
      const picture = await compose(session, session.mainBounds ?? session.bounds, thumbnail.tiles, table);
      // The old picture stays until the new one is there, and where that cannot be had.
      paint(canvas, picture);
      if (table === this.table) thumbnail.shown = versionOf(session);
    } catch {
      // Decoration: whether the server can be heard is told elsewhere; the next look tries again.
    } finally {
      thumbnail.underWay = false;
      this.underWay -= 1;
      this.drawDue();
    }
  }
}

function isDue({ session, inView, shown, triedAt, underWay }: Thumbnail): boolean {
  if (!inView || underWay || session.bounds === null || shown === versionOf(session)) return false;
  return performance.now() - triedAt >= kPaceMs;
}

function versionOf({ id, revision }: Session): string {
  return `${id} ${revision}`;
}

/** The map alone: what lasers saw, or where they saw nothing, sonars. */
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

/** Asks what has changed since the last time. */
async function versionsOf(session: Session, layer: LayerName, { byLayer }: KnownTiles): Promise<TileVersions> {
  const known = byLayer.get(layer) ?? { revision: 0, versions: new TileVersions() };
  byLayer.set(layer, known);
  const { signal } = new AbortController();
  const changes = await fetchChanges(session.name, { layer, since: known.revision, weave: null }, signal);
  known.versions.apply(changes.tiles);
  known.revision = changes.revision;
  return known.versions;
}

/** In the page's colours, with as many pixels as the tiles have. */
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

/** As large as it fits, in the middle; cells that are blown up keep their edges. */
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
