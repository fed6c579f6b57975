/** Maps that can be shown: those of a session as it grows, or those of a weave of it. */
import { fetchChanges, type SessionKey } from '../api/api';
import type { TileChange } from '../api/types';
import { forEachLayer, type LayerName } from '../layers/layers';
import { TileVersions } from './versions';

export interface MapSource {
  readonly session: SessionKey;
  readonly cellSize: number;
  /** Null: the session's own. */
  readonly weave: string | null;
  /**
   * Maps of one family are made in the same way from the same log: their tiles of the same revision are equal, whatever
   * weave they are of.
   */
  readonly family: string;
  /** What is known so far. */
  versions(layer: LayerName): TileVersions;
  /** Finds out what there is of the layer, unless it is known; changed() is called when more has become known. */
  need(layer: LayerName): void;
  /** Somebody looks no longer. */
  changed: ((layer: LayerName) => void) | null;
}

/** Those with a session's own settings: each change of exclusions changes tiles of the same revision. */
export const ownFamily = (exclusions: number): string => `own, exclusions ${exclusions}`;

/** What the live connection tells. */
export class LiveSource implements MapSource {
  readonly weave = null;
  changed: ((layer: LayerName) => void) | null = null;
  private readonly byLayer = forEachLayer(() => new TileVersions());

  constructor(
    readonly session: SessionKey,
    readonly cellSize: number,
    readonly family: string,
  ) {}

  versions(layer: LayerName): TileVersions {
    return this.byLayer[layer];
  }

  need(): void {}

  apply(layer: LayerName, tiles: TileChange[]): void {
    this.byLayer[layer].apply(tiles);
    this.changed?.(layer);
  }
}

/** Maps that do not change any more, asked about as they are needed. */
export class WeaveSource implements MapSource {
  changed: ((layer: LayerName) => void) | null = null;
  private readonly byLayer = forEachLayer(() => new TileVersions());
  private readonly asked = new Set<LayerName>();

  constructor(
    readonly session: SessionKey,
    readonly cellSize: number,
    readonly weave: string,
    readonly family: string,
    private readonly signal: AbortSignal,
    private readonly failed: (error: unknown) => void,
  ) {}

  versions(layer: LayerName): TileVersions {
    return this.byLayer[layer];
  }

  need(layer: LayerName): void {
    if (!this.asked.has(layer)) void this.load(layer).catch(() => {});
  }

  /** Resolves when the layer's tiles are known. @throws what fetchChanges does; failed() is told, too */
  async load(layer: LayerName): Promise<void> {
    this.asked.add(layer);
    try {
      const query = { layer, since: 0, weave: this.weave };
      const { tiles } = await fetchChanges(this.session.name, query, this.signal);
      this.byLayer[layer].apply(tiles);
    } catch (error) {
      this.asked.delete(layer);
      if (!this.signal.aborted) this.failed(error);
      throw error;
    }
    this.changed?.(layer);
  }
}
