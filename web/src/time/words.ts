/** Formats moments and durations of a session. */
import { MalformedAnswer } from '../api/decode';
import { Refused, Unreachable } from '../api/http';
import type { PastPoses } from '../api/weaves';
import { count } from '../format';
import { WeaveFailed } from './time_travel';
import type { Timeline } from './timeline';

/** "+01:35", "+1:01:35". */
export function elapsed(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  const [hours, minutes, rest] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  const tail = `${twoDigits(minutes)}:${twoDigits(rest)}`;
  return hours > 0 ? `+${hours}:${tail}` : `+${tail}`;
}

/** "45 s", "12 min", "1 h 2 min", "3 d 4 h". */
export function duration(seconds: number): string {
  const minutes = Math.round(seconds / 60);
  if (seconds < 60) return `${Math.round(seconds)} s`;
  if (minutes < 60) return `${minutes} min`;
  if (minutes < 24 * 60) return pair(minutes, 60, 'h', 'min');
  return pair(Math.round(minutes / 60), 24, 'd', 'h');
}

/** "12:03:05 (+01:35)"; only the offset when the robots' clocks have no time of day. */
export function timeOf(timeline: Timeline, index: number): string {
  const since = elapsed(timeline.sinceStart(index));
  return timeline.isWallClock ? `${timeOfDay(timeline.timeOf(index))} (${since})` : since;
}

/** "scan 120 of 910, 12:03:05 (+01:35)". */
export function scanOf(timeline: Timeline, index: number): string {
  return `scan ${count(index + 1)} of ${count(timeline.count)}, ${timeOf(timeline, index)}`;
}

/** The date of the scan; empty when the robots' clocks have none. */
export function dateOf(timeline: Timeline, index: number): string {
  if (!timeline.isWallClock) return '';
  return new Date(1000 * timeline.timeOf(index)).toLocaleDateString(undefined, { dateStyle: 'medium' });
}

/** Returns what is shown of an earlier time. @param date empty: unknown */
export function pastOf(date: string, poses: PastPoses | null): string {
  return `${shownOf(date === '' ? '' : `, ${date}`, poses)}; newest scans, goals, frontiers and landmarks are hidden.`;
}

function shownOf(date: string, poses: PastPoses | null): string {
  switch (poses) {
    case 'then':
      return `Map as it was believed to be then${date}; robots and trails at the poses known today`;
    case 'now':
      return `Map, robots and trails of that time${date}, at the poses known today`;
    case null:
      return `Map, robots and trails as they were then${date}`;
  }
}

/** @param share loaded part, 0 to 1 */
export function loading(share: number): string {
  const percent = Math.floor(100 * share);
  return percent > 0 ? `Loading the history\u2026 ${percent} %` : 'Loading the history\u2026';
}

/** Returns why a moment cannot be shown. @param trying whether the request is retried */
export function troubleOf(error: unknown, trying: boolean): string {
  const again = trying ? ' Trying again.' : '';
  if (error instanceof Unreachable) return `Offline: the server does not answer; the map stays as it is.${again}`;
  if (error instanceof Refused && error.status === 404)
    return 'The server no longer has that map and computes it again.';
  const because = `${reasonOf(error)}.`.replace(/\.\.$/, '.');
  return `That moment cannot be shown; the map stays as it is. ${because}${again}`;
}

function reasonOf(error: unknown): string {
  if (error instanceof Refused) return `The server reports: ${error.message}`;
  if (error instanceof WeaveFailed) return `The map could not be computed: ${error.message}`;
  if (error instanceof MalformedAnswer) return `The server's answer cannot be read: ${error.message}`;
  return `Something in this page failed: ${String(error)}`;
}

function timeOfDay(seconds: number): string {
  const parts = { hour: '2-digit', minute: '2-digit', second: '2-digit', hourCycle: 'h23' } as const;
  return new Date(1000 * seconds).toLocaleTimeString(undefined, parts);
}

function pair(value: number, base: number, large: string, small: string): string {
  const rest = value % base;
  return `${Math.floor(value / base)} ${large}${rest > 0 ? ` ${rest} ${small}` : ''}`;
}

function twoDigits(value: number): string {
  return String(value).padStart(2, '0');
}
