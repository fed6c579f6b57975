/** One row of the session list: thumbnail, size and activity. */
import type { DamagedSession, Session } from '../api/types';
import { hashOfSession } from '../address';
import { el, setText, type Row } from '../dom';
import * as format from '../format';

export interface SessionRow extends Row {
  link: HTMLAnchorElement;
  picture: HTMLCanvasElement;
  pace: HTMLElement;
  place: HTMLElement;
  online: HTMLElement;
  failed: HTMLElement;
  failure: HTMLElement;
  remove: HTMLButtonElement;
}

export interface DamagedRow extends Row {
  reason: HTMLElement;
}

export function createSessionRow({ name }: Session): SessionRow {
  const picture = el('canvas', { class: 'thumbnail', 'aria-hidden': 'true', width: '1', height: '1' });
  const online = el('span', { class: 'online' }, 'online');
  const failed = el('span', { class: 'damaged' }, 'accepts no scans');
  const [pace, place, failure] = [detail(), detail(), detail()];
  const title = el('span', { class: 'row-title' }, nameOf(name), online, failed);
  const words = el('span', { class: 'row-words' }, title, pace, place, failure);
  const link = el('a', { href: hashOfSession(name), class: 'row' }, picture, words);
  const remove = removeButton(name);
  const element = el('li', { class: 'session', 'data-session': name }, link, remove);
  return { element, link, picture, pace, place, online, failed, failure, remove };
}

/**
 * Shows the session's newest values.
 *
 * @param rate      scans per second; null where unknown
 * @param isOffline the server does not answer: hides rates and online states
 */
export function updateSessionRow(row: SessionRow, session: Session, rate: number | null, isOffline: boolean): void {
  const isOnline = !isOffline && session.robots.some(({ connected }) => connected);
  const busy = !isOffline && rate !== null && (isOnline || rate > 0) ? [`${format.decimal(rate, 1)} scans/s`] : [];
  setText(row.pace, [format.counted(session.scans, 'scan'), ...busy].join(' \u00b7 '));
  const area = session.bounds ? format.area(session.bounds) : 'no scans yet';
  setText(row.place, [area, robotsOf(session, isOffline)].join(' \u00b7 '));
  row.failed.hidden = row.failure.hidden = session.failure === null;
  setText(row.failure, session.failure ?? '');
  row.online.hidden = !isOnline;
}

/** A session that cannot be opened, because the server cannot reconstruct its map. */
export function createDamagedRow({ name }: DamagedSession, remove: (name: string) => void): DamagedRow {
  const reason = detail();
  const title = el('span', { class: 'row-title' }, nameOf(name), el('span', { class: 'damaged' }, 'not served'));
  const button = removeButton(name);
  button.addEventListener('click', () => remove(name));
  const words = el('div', { class: 'row' }, el('span', { class: 'row-words' }, title, reason));
  return { element: el('li', { class: 'session', 'data-session': name }, words, button), reason };
}

function robotsOf({ robots }: Session, isOffline: boolean): string {
  if (robots.length === 0) return 'no robots';
  if (isOffline) return format.counted(robots.length, 'robot');
  const online = robots.filter(({ connected }) => connected).length;
  return `${format.count(online)} of ${format.count(robots.length)} online`;
}

function nameOf(name: string): HTMLElement {
  return el('span', { class: 'row-name', dir: 'auto' }, name);
}

function detail(): HTMLElement {
  return el('span', { class: 'row-detail numeric' });
}

function removeButton(name: string): HTMLButtonElement {
  return el('button', { type: 'button', class: 'remove', 'aria-label': `Delete ${name}`, title: 'Delete' }, trash());
}

function trash(): SVGElement {
  const namespace = 'http://www.w3.org/2000/svg';
  const picture = document.createElementNS(namespace, 'svg');
  picture.setAttribute('viewBox', '0 0 16 16');
  picture.setAttribute('aria-hidden', 'true');
  const path = document.createElementNS(namespace, 'path');
  path.setAttribute('d', 'M2.5 4.5h11M6 4.5v-2h4v2M4 4.5l.6 9h6.8l.6-9M6.7 7v4M9.3 7v4');
  picture.append(path);
  return picture;
}
