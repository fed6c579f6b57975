/** What of a session's maps is on the screen: which layer, of which maps, beside which other. */
import { layerBeside, type LayerName } from './layers/layers';
import type { MapView, Shown } from './map/map_view';
import type { MapSource } from './map/map_source';

/** How the second layer is shown: right of a line that is dragged, or lying on the first. */
export type BesideMode = 'swipe' | 'over';

export interface PictureState {
  layer: LayerName;
  /** The second layer; null: none, unless there is a comparison. */
  besideLayer: LayerName | null;
  mode: BesideMode;
  /** From 0 to 1. */
  opacity: number;
  besideOpacity: number;
  /** Where the swipe's line is, from 0 on the left to 1. */
  divider: number;
}

const kAtFirst: PictureState = {
  layer: 'occupancy',
  besideLayer: null,
  mode: 'swipe',
  opacity: 1,
  besideOpacity: 0.6,
  divider: 0.5,
};

export class Picture {
  private state: PictureState = kAtFirst;
  /** The session as it grows; null: no session is open. */
  private present: MapSource | null = null;
  /** Maps of an earlier time, in its place. */
  private moment: MapSource | null = null;
  /** Maps that were made otherwise, on the second side. */
  private comparison: MapSource | null = null;
  private listeners: (() => void)[] = [];

  constructor(private readonly map: MapView) {}

  get now(): PictureState {
    return this.state;
  }

  /** Called whenever something else is shown, until the signal aborts. */
  listen(listener: () => void, signal?: AbortSignal): void {
    this.listeners.push(listener);
    signal?.addEventListener('abort', () => (this.listeners = this.listeners.filter((each) => each !== listener)));
  }

  /** Another session's maps, or none. */
  open(present: MapSource | null): void {
    for (const source of [this.moment, this.comparison]) if (source) source.changed = null;
    this.moment = this.comparison = null;
    this.present = present;
    if (present) present.changed = () => this.map.renew();
    this.update();
  }

  change(change: Partial<PictureState>): void {
    this.state = { ...this.state, ...change };
    this.update();
  }

  /** So many layers further on. */
  step(steps: number): void {
    this.change({ layer: layerBeside(this.state.layer, steps) });
  }

  /** Maps of an earlier time; null: back to the present. */
  showMoment(moment: MapSource | null): void {
    this.moment = this.follow(this.moment, moment);
    this.update();
  }

  /** Maps to be seen on the second side; null: no more. */
  compareWith(comparison: MapSource | null): void {
    this.comparison = this.follow(this.comparison, comparison);
    this.update();
  }

  get main(): Shown | null {
    const source = this.moment ?? this.present;
    return source && { source, layer: this.state.layer };
  }

  get beside(): Shown | null {
    const { layer, besideLayer } = this.state;
    if (this.comparison) return { source: this.comparison, layer: besideLayer ?? layer };
    const source = this.moment ?? this.present;
    return source && besideLayer ? { source, layer: besideLayer } : null;
  }

  /** Those of the session's own maps that are shown. */
  layersOfSession(): LayerName[] {
    const { layer, besideLayer } = this.state;
    return besideLayer && !this.comparison ? [layer, besideLayer] : [layer];
  }

  /** Whether maps of an earlier time are shown. */
  get isPast(): boolean {
    return this.moment !== null;
  }

  /** Whether there is a line between two sides now. */
  get isSwiping(): boolean {
    return this.state.mode === 'swipe' && this.beside !== null;
  }

  /** What is seen at that part of the map's width. */
  shownAt(share: number): Shown | null {
    return this.isSwiping && share > this.state.divider ? this.beside : this.main;
  }

  private follow(before: MapSource | null, now: MapSource | null): MapSource | null {
    if (before && before !== now) before.changed = null;
    if (now) now.changed = () => this.map.renew();
    return now;
  }

  private update(): void {
    const { mode, opacity, besideOpacity, divider } = this.state;
    if (this.main) {
      this.map.show(this.main, this.beside);
      this.map.setOpacity(opacity, mode === 'over' ? besideOpacity : 1);
      this.map.setDivider(this.isSwiping ? divider : null);
    }
    for (const listener of this.listeners) listener();
  }
}
