/** Where the person points at, in metres and cells, and what is known there. */
import type OlMap from 'ol/Map';
import type { Landmark } from '../api/types';
import { byId, el, setText } from '../dom';
import * as format from '../format';
import type { CellReaders } from '../map/cell_readers';
import { cellAt } from '../map/grid';
import type { Shown } from '../map/map_view';
import type { CellValue } from '../layers/cell_value';
import { kLayerTitles, type LayerName } from '../layers/layers';
import type { Picture } from '../picture';

/** What is under the cursor belongs to the maps of a session. */
export interface CursorScene {
  readers: CellReaders;
  picture: Picture;
  landmarkAt: (place: number[]) => Landmark | null;
}

export class Cursor {
  private readonly fields = {
    box: byId('cursor', HTMLElement),
    x: byId('cursor-x', HTMLElement),
    y: byId('cursor-y', HTMLElement),
    cell: byId('cursor-cell', HTMLElement),
    /** Of the layer that is seen there. */
    value: byId('cursor-value', HTMLElement),
    /** Of the others. */
    others: byId('cursor-others', HTMLElement),
    crosshair: byId('crosshair', HTMLElement),
  };
  private pixel: number[] | null = null;
  private scene: CursorScene | null = null;

  constructor(
    private readonly map: OlMap,
    private readonly target: HTMLElement,
  ) {
    map.on('pointermove', ({ pixel }) => this.pointAt(pixel));
    map.on('click', ({ pixel }) => this.pointAt(pixel));
    map.on('postrender', () => this.update());
    target.addEventListener('pointerleave', (event) => {
      // A finger that is lifted still means the place that it touched.
      if (event.pointerType === 'mouse') this.pointAt(null);
    });
    // Whoever steers by keys means the middle, wherever the pointer was left.
    target.addEventListener('keydown', () => this.pointAt(null));
    for (const event of ['focus', 'blur']) target.addEventListener(event, () => this.update());
  }

  show(scene: CursorScene | null): void {
    this.scene = scene;
    this.update();
  }

  update(): void {
    const byKeyboard = this.pixel === null && this.target.matches(':focus-visible');
    const [width = 1] = this.map.getSize() ?? [];
    const at = byKeyboard ? this.map.getView().getCenter() : this.pixel && this.map.getCoordinateFromPixel(this.pixel);
    const shown = this.scene?.picture.shownAt(byKeyboard ? 0.5 : (this.pixel?.[0] ?? 0) / width) ?? null;
    this.fields.box.hidden = !(shown && at);
    this.fields.crosshair.hidden = !(shown && at && byKeyboard);
    if (this.scene && shown && at) this.tell(this.scene.readers, shown, at, this.scene.landmarkAt(at));
  }

  private pointAt(pixel: number[] | null): void {
    this.pixel = pixel;
    this.update();
  }

  private tell(
    readers: CellReaders,
    { source, layer }: Shown,
    [x = 0, y = 0]: number[],
    landmark: Landmark | null,
  ): void {
    const cell = cellAt(x, y, source.cellSize);
    setText(this.fields.x, format.decimal(x, 2));
    setText(this.fields.y, format.decimal(y, 2));
    setText(this.fields.cell, `${format.integer(cell.i)}, ${format.integer(cell.j)}`);
    const [shown, ...others] = readers.all(source, layer);
    setText(this.fields.value, shown ? format.cellValue(shown.read(cell)) : '');
    const values = others.flatMap((reader) => otherValue(reader.layer, reader.read(cell)));
    this.tellOthers(landmark ? [landmarkValue(landmark), ...values] : values);
  }

  private tellOthers(values: OtherValue[]): void {
    const fingerprint = JSON.stringify(values);
    if (this.fields.others.dataset['values'] === fingerprint) return;
    this.fields.others.dataset['values'] = fingerprint;
    this.fields.others.replaceChildren(
      ...values.map(({ title, text }) => el('div', {}, el('dt', {}, title), el('dd', {}, text))),
    );
  }
}

interface OtherValue {
  title: string;
  text: string;
}

function landmarkValue({ id, seen, size: [width, height] }: Landmark): OtherValue {
  const size = `${format.decimal(width, 2)} \u00d7 ${format.decimal(height, 2)} m`;
  return { title: 'Landmark', text: `#${id}: ${size}, seen ${seen === 1 ? 'once' : `${format.count(seen)} times`}` };
}

/** Of layers that know nothing there, nothing. */
function otherValue(layer: LayerName, value: CellValue): OtherValue[] {
  if (value.kind === 'unknown' || value.kind === 'loading') return [];
  if (value.kind === 'class' && value.name === 'unexplored') return [];
  return [{ title: kLayerTitles[layer], text: format.cellValue(value) }];
}
