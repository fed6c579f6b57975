/** Formats numbers and times for people. */
import type { Bounds, Pose } from './api/types';
import type { CellValue } from './layers/cell_value';

const kMinus = '\u2212';
const kThinSpace = '\u202f';

/** 13631 -> "13 631", with thin spaces. */
export function count(value: number): string {
  return String(value).replace(/\B(?=(\d{3})+$)/g, kThinSpace);
}

/** "1 scan", "2 scans". */
export function counted(value: number, noun: string): string {
  return `${count(value)} ${noun}${value === 1 ? '' : 's'}`;
}

/** "13 631 scans are being moved to corrected poses." */
export function movingScans(value: number): string {
  return `${counted(value, 'scan')} ${value === 1 ? 'is' : 'are'} being moved to corrected poses.`;
}

/** Fixed decimals and a real minus sign, so that columns line up; never "-0.00". */
export function decimal(value: number, digits: number): string {
  const text = value.toFixed(digits);
  if (!text.startsWith('-')) return text;
  return Number(text) === 0 ? text.slice(1) : kMinus + text.slice(1);
}

export function integer(value: number): string {
  return decimal(value, 0);
}

/** "12.34 m", or "1.23 km" from one kilometre. */
export function length(metres: number): string {
  if (Math.abs(metres) >= 1000) return `${decimal(metres / 1000, 2)} km`;
  return `${decimal(metres, metres >= 100 ? 0 : 1)} m`;
}

/** "1.23 m", "123.4 m", "1.234 km". */
export function distance(metres: number): string {
  return metres >= 1000 ? `${decimal(metres / 1000, 3)} km` : `${decimal(metres, metres >= 100 ? 1 : 2)} m`;
}

/** A length without needless digits: "0.5 m", "20 m", "2 km". */
export function roundLength(metres: number): string {
  return metres >= 1000 ? `${metres / 1000} km` : `${Number(metres.toPrecision(3))} m`;
}

/** Truncates texts that would cover too much of the map. */
export function shortened(text: string, lengthMax: number): string {
  const letters = [...text];
  return letters.length <= lengthMax ? text : `${letters.slice(0, lengthMax - 1).join('')}\u2026`;
}

/** "5 cm", "12.5 cm", "1 m". */
export function cellSize(metres: number): string {
  return metres < 1 ? `${Number((metres * 100).toFixed(2))} cm` : `${Number(metres.toFixed(3))} m`;
}

export function area({ minX, minY, maxX, maxY }: Bounds): string {
  return `${decimal(maxX - minX, 1)} \u00d7 ${decimal(maxY - minY, 1)} m`;
}

/** "x 1.20, y −0.40 m, 45°"; degrees in (-180, 180]. */
export function pose({ x, y, yaw }: Pose): string {
  return `x ${decimal(x, 2)}, y ${decimal(y, 2)} m, ${integer((yaw * 180) / Math.PI)}\u00b0`;
}

export function cellValue(value: CellValue): string {
  switch (value.kind) {
    case 'percent':
      return `${value.percent} % occupied`;
    case 'counter':
      return `counter ${value.count}`;
    case 'class':
      return value.name;
    case 'unknown':
      return 'unknown';
    case 'loading':
      return '\u2026';
  }
}

/** @param iso a time stamp of the server; shown unchanged when it cannot be parsed */
export function moment(iso: string): string {
  const time = new Date(iso);
  if (Number.isNaN(time.getTime())) return iso;
  return time.toLocaleString(undefined, { dateStyle: 'medium', timeStyle: 'short' });
}
