/** The selection on the screen: the layer, its maps, and the second layer. */
import { nextLayer, type LayerName } from './layers/layers';
import type { MapView, Shown } from './map/map_view';
import type { MapSource } from './map/map_source';

/** Display of the second layer: right of the swipe line, or on top of the first layer. */
export type SecondMode = 'swipe' | 'over';

export interface PictureState {
  layer: LayerName;
  /** The second layer; null: none, unless there is a comparison. */
  secondLayer: LayerName | null;
  mode: SecondMode;
  /** From 0 to 1. */
  opacity: number;
  secondOpacity: number;
  /** Position of the swipe line, from 0 on the left to 1. */
  divider: number;
}

const kAtFirst: PictureState = {
  layer: 'occupancy',
  secondLayer: null,
  mode: 'swipe',
  opacity: 1,
  secondOpacity: 0.6,
  divider: 0.5,
};

export class Picture {
  private state: PictureState = kAtFirst;
  /** The live session; null: no session is open. */
  private present: MapSource | null = null;
  /** Maps of an earlier time, shown instead of the live ones. */
  private moment: MapSource | null = null;
  /** Maps with other settings, shown on the second side. */
  private comparison: MapSource | null = null;
  private listeners: (() => void)[] = [];

  constructor(private readonly map: MapView) {}

  get now(): PictureState {
    return this.state;
  }

  /** Calls the listener after every change until the signal aborts. */
  listen(listener: () => void, signal?: AbortSignal): void {
    this.listeners.push(listener);
    signal?.addEventListener('abort', () => (this.listeners = this.listeners.filter((each) => each !== listener)));
  }

  /** Shows another session's maps, or none. */
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

  /** Moves on by this many layers. */
  step(steps: number): void {
    this.change({ layer: nextLayer(this.state.layer, steps) });
  }

  /** Shows maps of an earlier time; null: returns to the present. */
  showMoment(moment: MapSource | null): void {
    this.moment = this.follow(this.moment, moment);
    this.update();
  }

  /** Shows maps on the second side; null: removes them. */
  compareWith(comparison: MapSource | null): void {
    this.comparison = this.follow(this.comparison, comparison);
    this.update();
  }

  get main(): Shown | null {
    const source = this.moment ?? this.present;
    return source && { source, layer: this.state.layer };
  }

  get second(): Shown | null {
    const { layer, secondLayer } = this.state;
    if (this.comparison) return { source: this.comparison, layer: secondLayer ?? layer };
    const source = this.moment ?? this.present;
    return source && secondLayer ? { source, layer: secondLayer } : null;
  }

  /** The session's own maps that are shown. */
  layersOfSession(): LayerName[] {
    const { layer, secondLayer } = this.state;
    return secondLayer && !this.comparison ? [layer, secondLayer] : [layer];
  }

  /** Whether maps of an earlier time are shown. */
  get isPast(): boolean {
    return this.moment !== null;
  }

  /** Whether there is a swipe line now. */
  get isSwiping(): boolean {
    return this.state.mode === 'swipe' && this.second !== null;
  }

  /** Returns the layer that is visible at this part of the map's width. */
  shownAt(share: number): Shown | null {
    return this.isSwiping && share > this.state.divider ? this.second : this.main;
  }

  private follow(before: MapSource | null, now: MapSource | null): MapSource | null {
    if (before && before !== now) before.changed = null;
    if (now) now.changed = () => this.map.renew();
    return now;
  }

  private update(): void {
    const { mode, opacity, secondOpacity, divider } = this.state;
    if (this.main) {
      this.map.show(this.main, this.second);
      this.map.setOpacity(opacity, mode === 'over' ? secondOpacity : 1);
      this.map.setDivider(this.isSwiping ? divider : null);
    }
    for (const listener of this.listeners) listener();
  }
}
