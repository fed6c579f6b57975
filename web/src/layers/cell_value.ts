/** The meaning of a cell's code, for each layer. */
import type { LayerName } from './layers';

export const kClasses = ['unexplored', 'free', 'occupied', 'frontier', 'danger'] as const;

export type CellClass = (typeof kClasses)[number];

export type CellValue =
  | { kind: 'percent'; percent: number }
  | { kind: 'counter'; count: number }
  | { kind: 'class'; name: CellClass }
  | { kind: 'unknown' }
  | { kind: 'loading' };

const kUnknownCode = 255;

/** @param code from the server's .bin tiles */
export function valueOf(layer: LayerName, code: number): CellValue {
  if (layer === 'classification') return { kind: 'class', name: kClasses[code] ?? 'unexplored' };
  if (code === kUnknownCode) return { kind: 'unknown' };
  return layer === 'himm' ? { kind: 'counter', count: code } : { kind: 'percent', percent: code };
}
