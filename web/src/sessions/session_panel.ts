/** The panel of all sessions: search, order, list, and the dialogs that create and delete sessions. */
import type { DamagedSession, Session } from '../api/types';
import { isUnauthorized, Refused, Unreachable } from '../api/http';
import { byId, setText } from '../dom';
import { count, counted } from '../format';
import type { Theme } from '../theme';
import { CreateDialog } from './create_dialog';
import { DeleteDialog, type DeleteEvents } from './delete_dialog';
import { arrange, keepOrder, matches, type Order } from './order';
import { SessionRates } from './rates';
import { SessionList } from './session_list';

export interface SessionPanelEvents extends DeleteEvents {
  created(session: Session): void;
  /** The panel has to be open, because the search field gets the focus. */
  wanted(): void;
}

const kOrders: readonly string[] = ['newest', 'name', 'busiest'] satisfies Order[];

export class SessionPanel {
  private readonly search = byId('session-search', HTMLInputElement);
  private readonly order = byId('session-order', HTMLSelectElement);
  private readonly countLine = byId('session-count', HTMLElement);
  private readonly state = byId('sessions-state', HTMLElement);
  private readonly rates = new SessionRates();
  private readonly list: SessionList;
  private readonly deletion: DeleteDialog;
  /** Ids of sessions that were deleted here: an answer that was sent before may still contain them. */
  private readonly deleted = new Set<string>();
  private sessions: Session[] = [];
  private damaged: DamagedSession[] = [];
  private received = false;
  private trouble: unknown = null;

  constructor(
    theme: Theme,
    private readonly events: SessionPanelEvents,
  ) {
    this.list = new SessionList(
      byId('sessions', HTMLElement),
      byId('damaged', HTMLElement),
      theme.cells,
      (name) => this.rates.of(name),
      { remove: (name) => this.confirm(name), leave: () => this.search.focus() },
    );
    this.deletion = new DeleteDialog({ ...events, deleted: (name, session) => this.forget(name, session) });
    this.connect();
    this.arrange();
  }

  /** All sessions, whether they match the search or not. */
  get all(): Session[] {
    return this.sessions;
  }

  /** @returns the sessions of the answer, without those that were deleted here since the request was sent */
  show(sessions: Session[], damaged: DamagedSession[]): Session[] {
    this.received = true;
    this.sessions = sessions.filter(({ id }) => !this.deleted.has(id));
    this.damaged = damaged;
    this.rates.learn(this.sessions, performance.now());
    this.arrange();
    return this.sessions;
  }

  /** Called when one of the sessions has changed. */
  refresh(session: Session): void {
    this.sessions = this.sessions.map((each) => (each.name === session.name ? session : each));
    this.list.refresh(session);
  }

  choose(name: string): void {
    this.list.choose(name);
  }

  /** @param error null after success */
  settle(error: unknown): void {
    this.trouble = error;
    this.showState();
  }

  /** @param isOffline whether the server does not answer */
  setOffline(isOffline: boolean): void {
    this.list.setOffline(isOffline);
    this.arrange();
  }

  setTheme(theme: Theme): void {
    this.list.setPalette(theme.cells);
  }

  private connect(): void {
    const creation = new CreateDialog((session) => this.add(session));
    byId('new-session', HTMLButtonElement).addEventListener('click', () => creation.open());
    this.search.addEventListener('input', () => this.arrange());
    this.search.addEventListener('keydown', (event) => this.pressInSearch(event));
    this.order.addEventListener('change', () => this.arrange(true));
  }

  /** Opens the list and focuses the search field. */
  focusSearch(): void {
    this.events.wanted();
    this.search.focus();
    this.search.select();
  }

  private pressInSearch(event: KeyboardEvent): void {
    if (event.key === 'Escape') {
      this.search.value = '';
      this.arrange();
    } else if (event.key !== 'ArrowDown' || !this.list.focus(0)) {
      return;
    }
    event.preventDefault();
  }

  private add(session: Session): void {
    this.sessions = [...this.sessions.filter(({ name }) => name !== session.name), session];
    this.search.value = '';
    this.arrange();
    this.events.created(session);
  }

  private confirm(name: string): void {
    this.deletion.open(name, this.sessions.find((session) => session.name === name) ?? null);
  }

  private forget(name: string, session: Session | null): void {
    const index = this.list.shown.indexOf(name);
    if (session) this.deleted.add(session.id);
    this.sessions = this.sessions.filter((each) => each.name !== name);
    this.damaged = this.damaged.filter((each) => each.name !== name);
    this.arrange();
    // The focused row has been removed.
    if (!this.list.focus(index)) this.search.focus();
    this.events.deleted(name, session);
  }

  /** @param reorder sorts the rows even if the pointer is on one */
  private arrange(reorder = false): void {
    const query = this.search.value.trim();
    const found = this.sessions.filter(({ name }) => matches(name, query));
    const damaged = this.damaged.filter(({ name }) => matches(name, query));
    const order = kOrders.includes(this.order.value) ? (this.order.value as Order) : 'newest';
    const arranged = arrange(found, order, (name) => this.rates.of(name));
    const held = order === 'busiest' && !reorder && this.list.isInUse;
    this.list.show(held ? keepOrder(arranged, this.list.shown) : arranged, damaged);
    this.showCount(found.length + damaged.length, query);
    this.showState();
  }

  private showCount(found: number, query: string): void {
    const all = this.sessions.length + this.damaged.length;
    const some = query === '' ? '' : `${count(found)} of `;
    setText(this.countLine, all > 0 ? `${some}${counted(all, 'session')}` : '');
  }

  private showState(): void {
    const all = this.sessions.length + this.damaged.length;
    const text = stateOf(this.received, all, this.trouble);
    this.state.dataset['state'] = this.trouble === null ? 'well' : 'trouble';
    this.state.hidden = text === '';
    setText(this.state, text);
  }
}

/** @param received whether the server has ever answered with its sessions */
function stateOf(received: boolean, all: number, trouble: unknown): string {
  const kept = received ? ' The list shows the last received state.' : '';
  if (trouble instanceof Unreachable) return `Offline.${kept}`;
  if (isUnauthorized(trouble)) return '';
  if (trouble instanceof Refused) return `The list cannot be loaded: ${trouble.message}.${kept}`;
  if (trouble !== null) return `The server\u2019s list is invalid.${kept}`;
  if (!received) return 'Loading\u2026';
  return all === 0 ? 'No sessions yet.' : '';
}
