/** Has the server weave maps of earlier times, and fetches what is needed to show them. */
import type { SessionKey } from '../api/api';
import { deleteWeave, fetchWeave, startWeave, type Weave } from '../api/weaves';
import type { LayerName } from '../layers/layers';
import { ownFamily, WeaveSource, type MapSource } from '../map/map_source';

/** What a journey into the past needs of a server. */
export interface Weaver {
  /** The maps with the log's entries up to this revision. */
  start(revision: number): Promise<Weave>;
  progress(id: string): Promise<Weave>;
  /** Gives up one that is not done, or is needed no more. */
  cancel(id: string): Promise<void>;
  /**
   * Maps that are done: with all that is known of the layers that are looked at now.
   *
   * @param failed told when later another layer cannot be had
   */
  load(id: string, failed: (error: unknown) => void): Promise<MapSource>;
}

export class ServerWeaver implements Weaver {
  constructor(
    private readonly session: SessionKey,
    private readonly cellSize: number,
    private readonly layers: () => LayerName[],
    private readonly signal: AbortSignal,
  ) {}

  start(revision: number): Promise<Weave> {
    return startWeave(this.session.name, { until: revision }, this.signal);
  }

  progress(id: string): Promise<Weave> {
    return fetchWeave(this.session.name, id, this.signal);
  }

  /** Also when the session is left. */
  cancel(id: string): Promise<void> {
    return deleteWeave(this.session.name, id, new AbortController().signal);
  }

  async load(id: string, failed: (error: unknown) => void): Promise<MapSource> {
    const { exclusions } = await this.progress(id);
    const source = new WeaveSource(this.session, this.cellSize, id, ownFamily(exclusions), this.signal, failed);
    await Promise.all([...new Set(this.layers())].map((layer) => source.load(layer)));
    return source;
  }
}
