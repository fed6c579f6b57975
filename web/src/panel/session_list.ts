/** The sessions to choose from, and those that cannot be shown. */
import type { DamagedSession, Session } from '../api/types';
import { hashOfSession } from '../address';
import { el, KeyedList, setText, type Row } from '../dom';
import { counted } from '../format';

interface SessionRow extends Row {
  link: HTMLAnchorElement;
  summary: HTMLElement;
  live: HTMLElement;
  failed: HTMLElement;
  failure: HTMLElement;
}

interface DamagedRow extends Row {
  reason: HTMLElement;
}

export class SessionList {
  private readonly rows: KeyedList<Session, SessionRow>;
  private readonly damagedRows: KeyedList<DamagedSession, DamagedRow>;
  private chosen: string | null = null;
  private sessions: Session[] = [];

  constructor(list: HTMLElement, damagedList: HTMLElement) {
    this.rows = new KeyedList(list, ({ name }) => name, createRow, (row, session) => this.update(row, session));
    this.damagedRows = new KeyedList(
      damagedList,
      ({ name }) => name,
      createDamagedRow,
      (row, { reason }) => setText(row.reason, reason),
    );
  }

  show(sessions: Session[], damaged: DamagedSession[]): void {
    this.sessions = sessions;
    this.rows.show(sessions);
    this.damagedRows.show(damaged);
  }

  /** One of them has changed. */
  refresh(session: Session): void {
    this.rows.show((this.sessions = this.sessions.map((each) => (each.name === session.name ? session : each))));
  }

  choose(name: string): void {
    this.chosen = name;
    this.rows.show(this.sessions);
  }

  private update(row: SessionRow, session: Session): void {
    setText(row.summary, `${counted(session.scans, 'scan')} \u00b7 ${counted(session.robots.length, 'robot')}`);
    row.failed.hidden = row.failure.hidden = session.failure === null;
    setText(row.failure, session.failure ?? '');
    row.live.hidden = !session.robots.some(({ connected }) => connected);
    if (session.name === this.chosen) row.link.setAttribute('aria-current', 'true');
    else row.link.removeAttribute('aria-current');
  }
}

function createRow(session: Session): SessionRow {
  const summary = el('span', { class: 'row-detail' });
  const live = el('span', { class: 'live' }, 'live');
  const failed = el('span', { class: 'damaged' }, 'takes no scans');
  const failure = el('span', { class: 'row-detail' });
  const name = el('span', { class: 'row-name', dir: 'auto' }, session.name);
  const link = el('a', { href: hashOfSession(session.name), class: 'row' }, name, live, failed, summary, failure);
  return { element: el('li', {}, link), link, summary, live, failed, failure };
}

/** Nothing to open: the server cannot weave its map. */
function createDamagedRow({ name }: DamagedSession): DamagedRow {
  const reason = el('span', { class: 'row-detail' });
  const title = el('span', { class: 'row-name', dir: 'auto' }, name);
  const mark = el('span', { class: 'damaged' }, 'not served');
  return { element: el('li', {}, el('div', { class: 'row' }, title, mark, reason)), reason };
}
