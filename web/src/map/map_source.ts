/** Maps that can be shown: those of a live session, or those of a weave of it. */
import { fetchChanges, type SessionKey } from '../api/api';
import type { TileChange } from '../api/types';
import { forEachLayer, type LayerName } from '../layers/layers';
import { TileVersions } from './versions';

export interface MapSource {
  readonly session: SessionKey;
  readonly cellSize: number;
  /** Null: the session's own maps. */
  readonly weave: string | null;
  /**
   * Maps of one family are computed with the same settings from the same log: tiles of the same revision are equal,
   * even if they belong to different weaves.
   */
  readonly family: string;
  /** The versions known so far. */
  versions(layer: LayerName): TileVersions;
  /** Loads the versions of the layer, unless they are known; changed() is called when more have been loaded. */
  need(layer: LayerName): void;
  /** Called when the layer is no longer shown. */
  changed: ((layer: LayerName) => void) | null;
}

/** The family of maps with the session's own settings: each change of exclusions changes tiles of the same revision. */
export const ownFamily = (exclusions: number): string => `own, exclusions ${exclusions}`;

/** The session's maps, updated by the live connection. */
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

/** Maps that do not change, loaded on demand. */
export class WeaveSource implements MapSource {
  changed: ((layer: LayerName) => void) | null = null;
  private readonly byLayer = forEachLayer(() => new TileVersions());
  private readonly requested = new Set<LayerName>();

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
    if (!this.requested.has(layer)) void this.load(layer).catch(() => {});
  }

  /** Resolves when the layer's tiles are known. @throws the errors of fetchChanges, which failed() also receives */
  async load(layer: LayerName): Promise<void> {
    this.requested.add(layer);
    try {
      const query = { layer, since: 0, weave: this.weave };
      const { tiles } = await fetchChanges(this.session.name, query, this.signal);
      this.byLayer[layer].apply(tiles);
    } catch (error) {
      this.requested.delete(layer);
      if (!this.signal.aborted) this.failed(error);
      throw error;
    }
    this.changed?.(layer);
  }
}
