/** A region of the map that the user outlines: everything, a box by two corners, or a polygon. */
import Feature from 'ol/Feature';
import LineString from 'ol/geom/LineString';
import Polygon from 'ol/geom/Polygon';
import VectorLayer from 'ol/layer/Vector';
import type OlMap from 'ol/Map';
import VectorSource from 'ol/source/Vector';
import type { Point } from '../api/types';
import { kOrder } from '../map/order';
import type { ToolContext } from './context';
import { pathStyle } from './path_style';

export type Shape = 'everything' | 'box' | 'polygon';

/** A corner this close to the last one ends a polygon: the second click of a double click, Enter twice. */
const kSamePx = 6;

export class Region {
  private corners: Point[] = [];
  private done = false;
  private shape: Shape = 'everything';
  private readonly feature = new Feature();
  private readonly map: OlMap;

  constructor({ map, theme }: ToolContext, signal: AbortSignal) {
    this.map = map;
    const layer = new VectorLayer({
      source: new VectorSource({ features: [this.feature] }),
      style: (feature) => pathStyle(feature, theme().ink, theme().halo),
      zIndex: kOrder.marks,
    });
    const follow = ({ coordinate }: { coordinate: number[] }): void => {
      if (this.drawing) this.draw([coordinate[0] ?? 0, coordinate[1] ?? 0]);
    };
    map.addLayer(layer);
    map.on('pointermove', follow);
    signal.addEventListener('abort', () => {
      map.un('pointermove', follow);
      map.removeLayer(layer);
    });
  }

  /** Whether clicks add corners now. */
  get drawing(): boolean {
    return this.shape !== 'everything' && !this.done;
  }

  /** Whether there are enough corners to close the outline. */
  get closable(): boolean {
    return this.drawing && this.shape === 'polygon' && this.corners.length > 2;
  }

  /** Null: everything. */
  get outline(): Point[] | null {
    return this.shape !== 'everything' && this.done ? this.corners : null;
  }

  begin(shape: Shape): void {
    this.shape = shape;
    this.corners = [];
    this.done = false;
    this.draw(null);
  }

  /** Adds a corner. @returns whether it was the last one */
  add(corner: Point): boolean {
    const first = this.corners[0];
    const last = this.corners.at(-1);
    if (last && this.isNear(last, corner)) {
      if (this.closable) this.close();
      return this.done;
    }
    if (this.shape === 'box' && first) {
      this.corners = boxOf(first, corner);
      this.close();
    } else {
      this.corners.push(corner);
      this.draw(null);
    }
    return this.done;
  }

  close(): void {
    this.done = true;
    this.draw(null);
  }

  /** @param pointer position of the next corner */
  private draw(pointer: Point | null): void {
    const first = this.corners[0];
    const open = pointer ? [...this.corners, pointer] : this.corners;
    const box = this.shape === 'box' && first && pointer ? boxOf(first, pointer) : null;
    const ring = box ?? (this.done ? this.corners : null);
    if (ring && first) this.feature.setGeometry(new Polygon([[...ring, ring[0] ?? first]]));
    else this.feature.setGeometry(first ? new LineString(open) : undefined);
  }

  private isNear(one: Point, other: Point): boolean {
    const metres = Math.hypot(one[0] - other[0], one[1] - other[1]);
    return metres < kSamePx * (this.map.getView().getResolution() ?? 0);
  }
}

function boxOf([x0, y0]: Point, [x1, y1]: Point): Point[] {
  return [
    [x0, y0],
    [x1, y0],
    [x1, y1],
    [x0, y1],
  ];
}
