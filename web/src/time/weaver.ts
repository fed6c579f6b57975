/** Requests weaves of earlier times, and loads the data that are needed to show them. */
import type { SessionKey } from '../api/api';
import { deleteWeave, fetchWeave, startWeave, type PastPoses, type Weave } from '../api/weaves';
import type { LayerName } from '../layers/layers';
import { ownFamily, WeaveSource, type MapSource } from '../map/map_source';

/** The server requests that showing an earlier time needs. */
export interface Weaver {
  /** Requests the maps of the log's entries up to this revision. */
  start(revision: number): Promise<Weave>;
  progress(id: string): Promise<Weave>;
  /** Cancels an unfinished weave, or deletes one. */
  cancel(id: string): Promise<void>;
  /**
   * Loads a finished weave, with the versions of the layers that are shown now.
   *
   * @param failed called when another layer fails to load later
   */
  load(id: string, failed: (error: unknown) => void): Promise<MapSource>;
}

export class ServerWeaver implements Weaver {
  /** @param poses called for each request; null: no robot of the session has estimated poses */
  constructor(
    private readonly session: SessionKey,
    private readonly cellSize: number,
    private readonly poses: () => PastPoses | null,
    private readonly layers: () => LayerName[],
    private readonly signal: AbortSignal,
  ) {}

  start(revision: number): Promise<Weave> {
    const poses = this.poses();
    return startWeave(this.session.name, { until: revision, ...(poses && { poses }) }, this.signal);
  }

  progress(id: string): Promise<Weave> {
    return fetchWeave(this.session.name, id, this.signal);
  }

  /** Also called when the session is closed. */
  cancel(id: string): Promise<void> {
    return deleteWeave(this.session.name, id, new AbortController().signal);
  }

  async load(id: string, failed: (error: unknown) => void): Promise<MapSource> {
    const { exclusions } = await this.progress(id);
    // Estimated poses differ from moment to moment, so tiles of the same revision may differ, too.
    const family = this.poses() === null ? ownFamily(exclusions) : `weave ${id}`;
    const source = new WeaveSource(this.session, this.cellSize, id, family, this.signal, failed);
    await Promise.all([...new Set(this.layers())].map((layer) => source.load(layer)));
    return source;
  }
}
