/** Filter and order of the session list. */
import type { Session } from '../api/types';

export type Order = 'newest' | 'name' | 'busiest';

/** Returns the names that contain every word of the query, ignoring case. */
export function matches(name: string, query: string): boolean {
  const lower = name.toLocaleLowerCase();
  return query
    .toLocaleLowerCase()
    .split(/\s+/)
    .every((word) => lower.includes(word));
}

/** @param rate scans per second, null where unknown */
export function arrange(sessions: Session[], order: Order, rate: (name: string) => number | null): Session[] {
  const rates = new Map(sessions.map(({ name }) => [name, rate(name) ?? 0]));
  const busier = (a: Session, b: Session): number => (rates.get(b.name) ?? 0) - (rates.get(a.name) ?? 0);
  switch (order) {
    case 'name':
      return [...sessions].sort(byName);
    case 'newest':
      return [...sessions].sort((a, b) => newestFirst(a, b) || byName(a, b));
    case 'busiest':
      return [...sessions].sort((a, b) => busier(a, b) || newestFirst(a, b) || byName(a, b));
  }
}

/** Compares by creation time; sessions of the same second by their numbers. */
export function newestFirst(a: Session, b: Session): number {
  return compare(b.created, a.created) || b.number - a.number;
}

/** Keeps the previous order and appends new sessions: no row moves away under the pointer. */
export function keepOrder(sessions: Session[], before: string[]): Session[] {
  const places = new Map(before.map((name, index) => [name, index]));
  const place = ({ name }: Session): number => places.get(name) ?? before.length;
  return [...sessions].sort((a, b) => place(a) - place(b));
}

const kNames = new Intl.Collator(undefined, { numeric: true });

function byName(a: Session, b: Session): number {
  return kNames.compare(a.name, b.name) || compare(a.name, b.name);
}

function compare(a: string, b: string): number {
  return a < b ? -1 : a > b ? 1 : 0;
}
