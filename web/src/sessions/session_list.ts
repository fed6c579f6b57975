/** The list of sessions, and of those that cannot be shown. */
import type { DamagedSession, Session } from '../api/types';
import { KeyedList, setText } from '../dom';
import type { Palette } from '../layers/palette';
import { Roving } from './roving';
import { createDamagedRow, createSessionRow, updateSessionRow, type DamagedRow, type SessionRow } from './session_row';
import { Thumbnails } from './thumbnails';

export interface SessionListEvents {
  /** The user wants to delete the session. */
  remove(name: string): void;
  /** The focus leaves the list upwards. */
  leave(): void;
}

export class SessionList {
  private readonly rows: KeyedList<Session, SessionRow>;
  private readonly damagedRows: KeyedList<DamagedSession, DamagedRow>;
  private readonly byName = new Map<string, SessionRow>();
  private readonly roving: Roving;
  private readonly thumbnails: Thumbnails;
  private chosen: string | null = null;
  private names: string[] = [];
  private isOffline = false;
  /** The session that was scrolled into view last. */
  private revealed: string | null = null;

  /** @param rate scans per second; null where unknown */
  constructor(
    private readonly list: HTMLElement,
    damagedList: HTMLElement,
    palette: Palette,
    private readonly rate: (name: string) => number | null,
    private readonly events: SessionListEvents,
  ) {
    this.roving = new Roving(list, () => events.leave());
    this.thumbnails = new Thumbnails(palette);
    this.rows = new KeyedList(
      list,
      ({ name }) => name,
      (session) => this.create(session),
      (row, session) => this.update(row, session),
    );
    this.damagedRows = new KeyedList(
      damagedList,
      ({ name }) => name,
      (session) => createDamagedRow(session, (name) => events.remove(name)),
      (row, { reason }) => setText(row.reason, reason),
    );
  }

  /** The names in the order of the rows. */
  get shown(): string[] {
    return this.names;
  }

  /** Whether the pointer or the focus is on a row. */
  get isInUse(): boolean {
    return this.list.matches(':hover, :focus-within');
  }

  show(sessions: Session[], damaged: DamagedSession[]): void {
    this.names = sessions.map(({ name }) => name);
    const names = new Set(this.names);
    for (const name of this.byName.keys()) if (!names.has(name)) this.byName.delete(name);
    this.rows.show(sessions);
    this.damagedRows.show(damaged);
    const rows = this.names.flatMap((name) => this.byName.get(name) ?? []);
    const chosen = this.chosen === null ? undefined : this.byName.get(this.chosen);
    const stops = rows.map(({ link, remove }) => ({ link, others: [remove] }));
    this.roving.show(stops, chosen?.link ?? null);
    this.reveal();
    this.thumbnails.tend();
  }

  /** Called when one of the sessions has changed. */
  refresh(session: Session): void {
    const row = this.byName.get(session.name);
    if (row) this.update(row, session);
  }

  /** Takes effect with the next show(). @param isOffline whether the server does not answer */
  setOffline(isOffline: boolean): void {
    this.isOffline = isOffline;
  }

  choose(name: string): void {
    this.chosen = name;
    for (const [each, row] of this.byName) this.mark(row, each);
    this.reveal();
  }

  /** @return whether there is a row to focus */
  focus(index: number): boolean {
    return this.roving.focus(index);
  }

  setPalette(palette: Palette): void {
    this.thumbnails.setPalette(palette);
  }

  /** Scrolls to the open session, once. */
  private reveal(): void {
    const row = this.chosen === null ? undefined : this.byName.get(this.chosen);
    if (!row || this.revealed === this.chosen) return;
    this.revealed = this.chosen;
    const { offsetTop, offsetHeight } = row.element;
    const top = offsetTop - this.list.offsetTop;
    const { scrollTop, clientHeight } = this.list;
    if (top < scrollTop || top + offsetHeight > scrollTop + clientHeight) this.list.scrollTop = top;
  }

  private create(session: Session): SessionRow {
    const row = createSessionRow(session);
    row.remove.addEventListener('click', () => this.events.remove(session.name));
    this.byName.set(session.name, row);
    this.mark(row, session.name);
    return row;
  }

  private update(row: SessionRow, session: Session): void {
    updateSessionRow(row, session, this.rate(session.name), this.isOffline);
    this.thumbnails.show(row.picture, session);
  }

  private mark(row: SessionRow, name: string): void {
    if (name === this.chosen) row.link.setAttribute('aria-current', 'true');
    else row.link.removeAttribute('aria-current');
  }
}
