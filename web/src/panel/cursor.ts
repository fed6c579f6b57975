/** Where the person points at, in metres and cells, and what is known there. */
import type OlMap from 'ol/Map';
import { setText } from '../dom';
import * as format from '../format';
import { cellAt } from '../map/grid';
import type { CellReader } from '../map/cell_reader';

export interface CursorFields {
  box: HTMLElement;
  x: HTMLElement;
  y: HTMLElement;
  cell: HTMLElement;
  value: HTMLElement;
  crosshair: HTMLElement;
}

/** What is under the cursor belongs to a session's grid. */
export interface CursorScene {
  cellSize: number;
  reader: CellReader;
}

export class Cursor {
  private pixel: number[] | null = null;
  private scene: CursorScene | null = null;

  constructor(
    private readonly map: OlMap,
    private readonly target: HTMLElement,
    private readonly fields: CursorFields,
  ) {
    map.on('pointermove', ({ pixel }) => this.pointAt(pixel));
    map.on('click', ({ pixel }) => this.pointAt(pixel));
    map.on('postrender', () => this.update());
    target.addEventListener('pointerleave', (event) => {
      // A finger that is lifted still means the place that it touched.
      if (event.pointerType === 'mouse') this.pointAt(null);
    });
    for (const event of ['focus', 'blur']) target.addEventListener(event, () => this.update());
  }

  show(scene: CursorScene | null): void {
    this.scene = scene;
    this.update();
  }

  update(): void {
    const byKeyboard = this.pixel === null && this.target.matches(':focus-visible');
    const at = byKeyboard ? this.map.getView().getCenter() : this.pixel && this.map.getCoordinateFromPixel(this.pixel);
    this.fields.box.hidden = !(this.scene && at);
    this.fields.crosshair.hidden = !(this.scene && at && byKeyboard);
    if (this.scene && at) this.tell(this.scene, at);
  }

  private pointAt(pixel: number[] | null): void {
    this.pixel = pixel;
    this.update();
  }

  private tell({ cellSize, reader }: CursorScene, [x = 0, y = 0]: number[]): void {
    const cell = cellAt(x, y, cellSize);
    setText(this.fields.x, format.decimal(x, 2));
    setText(this.fields.y, format.decimal(y, 2));
    setText(this.fields.cell, `${format.integer(cell.i)}, ${format.integer(cell.j)}`);
    setText(this.fields.value, format.cellValue(reader.read(cell)));
  }
}
