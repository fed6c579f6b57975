/** The readout under the pointer: position in metres and cells, and the values there. */
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

/** The maps of a session that the pointer is over. */
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
    /** Value of the visible layer. */
    value: byId('cursor-value', HTMLElement),
    /** Values of the other layers. */
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
      // After a finger is lifted, the place that it touched stays selected.
      if (event.pointerType === 'mouse') this.pointAt(null);
    });
    // With the keyboard, the middle of the map is selected, wherever the pointer is.
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
    if (this.scene && shown && at) this.showValues(this.scene.readers, shown, at, this.scene.landmarkAt(at));
  }

  private pointAt(pixel: number[] | null): void {
    this.pixel = pixel;
    this.update();
  }

  private showValues(
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
    this.showOthers(landmark ? [landmarkValue(landmark), ...values] : values);
  }

  private showOthers(values: OtherValue[]): void {
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
  return {
    title: 'Landmark',
    text: `#${id}: ${size}, observed ${seen === 1 ? 'once' : `${format.count(seen)} times`}`,
  };
}

/** Returns nothing for layers without a value there. */
function otherValue(layer: LayerName, value: CellValue): OtherValue[] {
  if (value.kind === 'unknown' || value.kind === 'loading') return [];
  if (value.kind === 'class' && value.name === 'unexplored') return [];
  return [{ title: kLayerTitles[layer], text: format.cellValue(value) }];
}
