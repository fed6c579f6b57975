/** Shows a weave on the second side of the map until the comparison ends. */
import type { Session } from '../../api/types';
import type { ListedWeave } from '../../api/weave_list';
import { WeaveSource } from '../../map/map_source';
import type { Picture } from '../../picture';

export class Comparison {
  private leave = new AbortController();
  private shown: ListedWeave | null = null;

  constructor(private readonly picture: Picture) {}

  get weave(): ListedWeave | null {
    return this.shown;
  }

  /** @param failed called when its maps cannot be loaded */
  show(session: Session, weave: ListedWeave, failed: (error: unknown) => void): void {
    this.end();
    this.shown = weave;
    const source = new WeaveSource(session, weave.cellSize, weave.id, weave.id, this.leave.signal, failed);
    this.picture.change({ mode: 'swipe' });
    this.picture.compareWith(source);
  }

  end(): void {
    this.leave.abort();
    this.leave = new AbortController();
    if (this.shown) this.picture.compareWith(null);
    this.shown = null;
  }
}
