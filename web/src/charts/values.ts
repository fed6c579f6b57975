/** Formats the charts' values; a dash where there is none. */
import { count, decimal } from '../format';

const kNone = '\u2013';

type Value = number | null;

export function perSecond(value: Value): string {
  return value === null ? kNone : decimal(value, value < 100 ? 1 : 0);
}

export function milliseconds(seconds: Value): string {
  if (seconds === null) return kNone;
  const ms = seconds * 1000;
  return decimal(ms, ms < 10 ? 2 : ms < 100 ? 1 : 0);
}

export function scans(value: Value): string {
  return value === null ? kNone : `${count(Math.round(value))} ${value === 1 ? 'scan' : 'scans'}`;
}

/** 1 kB is 1000 bytes. */
export function bytes(value: Value): string {
  if (value === null) return kNone;
  if (value < 1e3) return `${Math.round(value)} B`;
  if (value < 1e6) return `${decimal(value / 1e3, 1)} kB`;
  return value < 1e9 ? `${decimal(value / 1e6, 1)} MB` : `${decimal(value / 1e9, 2)} GB`;
}

export function percent(value: Value): string {
  return value === null ? kNone : `${decimal(value, value < 10 ? 1 : 0)} %`;
}

/** Joins the values that exist. */
export function both(...texts: string[]): string {
  return texts.filter((text) => !text.endsWith(kNone)).join(', ') || kNone;
}

/** For an axis: "0.25", "40", "1.2k". */
export function short(value: number): string {
  if (value >= 1e6) return `${Number((value / 1e6).toPrecision(3))}M`;
  if (value >= 1e3) return `${Number((value / 1e3).toPrecision(3))}k`;
  return String(Number(value.toPrecision(3)));
}
