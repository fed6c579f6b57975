/** Numbers of the chosen session. */
import type { Session } from '../api/types';
import { el, setText } from '../dom';
import * as format from '../format';

const kFacts: [label: string, read: (session: Session) => string][] = [
  ['Scans', ({ scans }) => format.count(scans)],
  ['Area', ({ bounds }) => (bounds ? format.area(bounds) : 'no scans yet')],
  ['Cell', ({ cellSize }) => format.cellSize(cellSize)],
  ['Begun', ({ created }) => format.moment(created)],
  ['Mode', ({ isLocalizeOnly }) => (isLocalizeOnly ? 'Localize only: the map does not change' : 'Mapping')],
];

export class Facts {
  private readonly values: HTMLElement[];

  /** @param moving says how many scans are being moved; hidden while there are none */
  constructor(
    list: HTMLElement,
    private readonly moving: HTMLElement,
  ) {
    this.values = kFacts.map(([label]) => {
      const value = el('dd', { class: 'numeric' });
      list.append(el('div', {}, el('dt', {}, label), value));
      return value;
    });
  }

  show(session: Session): void {
    kFacts.forEach(([, read], index) => {
      const value = this.values[index];
      if (value) setText(value, read(session));
    });
    this.moving.hidden = session.movingScans === 0;
    setText(this.moving, format.movingScans(session.movingScans));
  }
}
