/** The visible part of the map: everything as it grows, a view chosen by the user, or a robot's surroundings. */
import { containsExtent, type Extent } from 'ol/extent';
import type Map from 'ol/Map';
import type { Bounds, Robot } from '../api/types';
import { motionMs } from '../motion';
import { freePadding, type Box, type Padding } from './free_area';

type Aim = { kind: 'everything' } | { kind: 'free' } | { kind: 'robot'; name: string };

/** Margin around fitted content. */
const kPaddingPx = 56;
const kPaddingShareMax = 0.08;
const kMoveMs = 250;
/** Limit of automatic zoom: metres per pixel for a room of a few metres. */
const kFitResolutionMin = 0.01;
/** A smaller change of the map element's size causes no new fit: it comes from a line of text next to it. */
const kResizedPx = 48;
/** Bounds may exceed the free part of the view by this much, which is rounding. */
const kTolerancePx = 1;
/** Growing bounds are fitted with this margin, so that the view does not move with every scan. */
const kRoomToGrow = 0.15;

export class Camera {
  private aim: Aim = { kind: 'everything' };
  private bounds: Bounds | null = null;
  private robots: Robot[] = [];
  private fitted = false;
  /** Bounds of the last fit. */
  private padding: Padding = [0, 0, 0, 0];
  /** Size of the map at the last fit. */
  private size: [width: number, height: number] = [0, 0];

  constructor(
    private readonly map: Map,
    private readonly target: HTMLElement,
    /** Controls that cover the map and are kept off fitted content. */
    private readonly controls: () => Box[],
    private readonly aimed: (robot: string | null) => void,
  ) {
    map.on('pointerdrag', () => this.isMapMoved() && this.free());
    map.on('change:size', () => this.resized());
    target.addEventListener('wheel', () => this.zoomed(), { passive: true });
    // While a tool takes clicks as places, a double click does not zoom.
    target.addEventListener('dblclick', () => target.classList.contains('picking') || this.zoomed());
    target.addEventListener('keydown', ({ key }) => {
      if (key.startsWith('Arrow')) this.free();
      else if (key === '+' || key === '-') this.zoomed();
    });
  }

  get followed(): string | null {
    return this.aim.kind === 'robot' ? this.aim.name : null;
  }

  /** Resets to showing everything, for another session. */
  reset(): void {
    this.bounds = null;
    this.robots = [];
    this.fitted = false;
    this.setAim({ kind: 'everything' });
  }

  see(bounds: Bounds | null, robots: Robot[]): void {
    this.bounds = bounds;
    this.robots = robots;
    this.update();
  }

  /** Shows everything, and continues to do so while the map grows. */
  fit(): void {
    this.setAim({ kind: 'everything' });
    if (this.bounds) this.fitTo(this.bounds, 0);
  }

  follow(robot: string): void {
    this.setAim({ kind: 'robot', name: robot });
    this.update();
  }

  /** The user moves the view: stop moving it automatically. */
  free(): void {
    if (this.aim.kind !== 'free') this.setAim({ kind: 'free' });
  }

  zoomBy(levels: number): void {
    this.zoomed();
    const view = this.map.getView();
    const zoom = view.getZoom();
    if (zoom !== undefined) view.animate({ zoom: zoom + levels, duration: motionMs(kMoveMs) });
  }

  /** OpenLayers marks features that are dragged instead of the map. */
  private isMapMoved(): boolean {
    return !this.target.classList.contains('ol-grabbing');
  }

  /** Zooming while a robot is followed keeps following it. */
  private zoomed(): void {
    if (this.aim.kind === 'everything') this.free();
  }

  private setAim(aim: Aim): void {
    this.aim = aim;
    this.aimed(this.followed);
  }

  /** Fits everything to the map's new size, unless the user has moved the view. */
  private resized(): void {
    const [width = 0, height = 0] = this.map.getSize() ?? [];
    const change = Math.max(Math.abs(width - this.size[0]), Math.abs(height - this.size[1]));
    if (this.fitted && this.aim.kind === 'everything' && this.bounds && width > 0 && change >= kResizedPx) {
      this.fitTo(this.bounds, 0);
    } else {
      this.update();
    }
  }

  private update(): void {
    if (!this.map.getSize()) return;
    if (this.aim.kind === 'robot') this.centreOn(this.aim.name);
    if (!this.bounds) return;
    if (!this.fitted || (this.aim.kind === 'everything' && !this.inView(this.bounds))) {
      this.fitTo(this.bounds, this.fitted ? kRoomToGrow : 0);
    }
  }

  private centreOn(name: string): void {
    const pose = this.robots.find((robot) => robot.name === name)?.pose;
    if (pose) this.map.getView().animate({ center: [pose.x, pose.y], duration: motionMs(kMoveMs), easing: (t) => t });
  }

  private fitTo(bounds: Bounds, room: number): void {
    const dx = (bounds.maxX - bounds.minX) * room;
    const dy = (bounds.maxY - bounds.minY) * room;
    const extent = [bounds.minX - dx, bounds.minY - dy, bounds.maxX + dx, bounds.maxY + dy];
    // Following a robot runs an animation, which would overwrite this view.
    this.map.getView().cancelAnimations();
    const [width = 0, height = 0] = this.map.getSize() ?? [];
    this.size = [width, height];
    this.padding = this.paddingOf(bounds);
    this.map.getView().fit(extent, {
      padding: this.padding,
      minResolution: kFitResolutionMin,
      duration: this.fitted ? motionMs(kMoveMs) : 0,
    });
    this.fitted = true;
  }

  private paddingOf({ minX, minY, maxX, maxY }: Bounds): Padding {
    const margin = Math.min(kPaddingPx, kPaddingShareMax * Math.min(...this.size));
    return freePadding(this.size, (maxX - minX) / (maxY - minY), margin, this.controls());
  }

  private inView(bounds: Bounds): boolean {
    const view = this.map.getView();
    // A running animation has the same target.
    return view.getAnimating() || containsExtent(this.freeExtent(), extentOf(bounds));
  }

  /** The visible extent, without the padding of the last fit: controls may cover it. */
  private freeExtent(): Extent {
    const view = this.map.getView();
    const [minX = 0, minY = 0, maxX = 0, maxY = 0] = view.calculateExtent(this.size);
    const resolution = view.getResolution() ?? 0;
    const [top, right, bottom, left] = this.padding.map((side) => (side - kTolerancePx) * resolution) as Padding;
    return [minX + left, minY + bottom, maxX - right, maxY - top];
  }
}

function extentOf({ minX, minY, maxX, maxY }: Bounds): Extent {
  return [minX, minY, maxX, maxY];
}
