/** The list of a session's weaves with their progress, to show or delete. */
import type { ListedWeave } from '../../api/weave_list';
import type { MapConfig } from '../../api/types';
import { el, KeyedList, setText, type Row } from '../../dom';
import * as format from '../../format';
import { describeChanges } from './settings_form';

export interface WeaveActions {
  show(weave: ListedWeave): void;
  remove(weave: ListedWeave): void;
}

interface WeaveRow extends Row {
  name: HTMLElement;
  detail: HTMLElement;
  progress: HTMLProgressElement;
  show: HTMLButtonElement;
  remove: HTMLButtonElement;
  weave: ListedWeave;
}

export class WeaveRows {
  readonly element = el('ul', { class: 'tool-weaves', 'aria-label': 'Weaves of this session' });
  private readonly rows: KeyedList<ListedWeave, WeaveRow>;
  private weaves: ListedWeave[] = [];
  private shown: string | null = null;

  constructor(
    private readonly config: () => MapConfig,
    private readonly actions: WeaveActions,
  ) {
    const create = (weave: ListedWeave): WeaveRow => this.create(weave);
    this.rows = new KeyedList(
      this.element,
      ({ id }) => id,
      create,
      (row, weave) => this.update(row, weave),
    );
  }

  show(weaves: ListedWeave[]): void {
    this.weaves = weaves;
    this.rows.show(weaves);
  }

  /** @param weave the one on the second side; null: none */
  mark(weave: string | null): void {
    this.shown = weave;
    this.rows.show(this.weaves);
  }

  private create(weave: ListedWeave): WeaveRow {
    const [name, detail] = [el('span', { class: 'row-name' }), el('span', { class: 'row-detail' })];
    const progress = el('progress', { 'aria-label': 'Progress' });
    const [show, remove] = [el('button', { type: 'button' }, 'Show'), el('button', { type: 'button' })];
    const element = el('li', { 'data-weave': weave.id }, name, detail, progress, show, remove);
    const row: WeaveRow = { element, name, detail, progress, show, remove, weave };
    show.addEventListener('click', () => this.actions.show(row.weave));
    remove.addEventListener('click', () => this.actions.remove(row.weave));
    return row;
  }

  private update(row: WeaveRow, weave: ListedWeave): void {
    const unfinished = isUnfinished(weave);
    row.weave = weave;
    setText(row.name, describeChanges(weave.config, this.config()));
    row.name.title = row.name.textContent ?? '';
    setText(row.detail, describeState(weave));
    row.progress.hidden = !unfinished;
    row.progress.max = Math.max(1, weave.until);
    row.progress.value = weave.applied;
    row.show.hidden = weave.state !== 'done';
    row.show.setAttribute('aria-pressed', String(weave.id === this.shown));
    row.show.setAttribute('aria-label', `Show ${row.name.textContent ?? ''}`);
    setText(row.remove, unfinished ? 'Cancel' : 'Delete');
    row.remove.setAttribute('aria-label', `${unfinished ? 'Cancel' : 'Delete'} ${row.name.textContent ?? ''}`);
  }
}

export function isUnfinished({ state }: ListedWeave): boolean {
  return state === 'waiting' || state === 'weaving';
}

function describeState({ state, applied, until, follows, reason }: ListedWeave): string {
  const end = follows ? '' : `, until entry ${format.count(until)}`;
  switch (state) {
    case 'waiting':
      return 'waiting';
    case 'weaving':
      return `${format.count(applied)} of ${format.count(until)} entries`;
    case 'done':
      return `${format.count(applied)} entries${end}`;
    case 'failed':
    case 'cancelled':
      return reason === '' ? state : `${state}: ${reason}`;
  }
}
