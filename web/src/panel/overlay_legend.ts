/** The overlays' symbols and their meaning, drawn as on the map, in the same colours. */
import { el } from '../dom';
import type { Settings } from '../settings';

interface Entry {
  label: string;
  /** Class of the symbol, which the style sheet colours. */
  symbol: string;
  /** Path of the symbol in a square of 16. */
  path: string;
}

const kSvg = 'http://www.w3.org/2000/svg';

const kEntries: Partial<Record<keyof Settings, Entry[]>> = {
  frontiers: [
    { label: 'can be reached', symbol: 'frontier-area', path: 'M2 3h12v10H2z' },
    { label: 'cannot be reached', symbol: 'frontier-outline', path: 'M2 3h12v10H2z' },
    { label: 'where to stand', symbol: 'frontier-goal', path: 'M8 4a4 4 0 1 1-.01 0z' },
  ],
  landmarks: [
    { label: 'observed repeatedly', symbol: 'landmark', path: 'm8 2 6 6-6 6-6-6z' },
    { label: 'observed once', symbol: 'landmark-once', path: 'M8 3.5 13 12.5H3z' },
  ],
  poseGraph: [
    { label: 'keyframe', symbol: 'keyframe', path: 'M8 5.5a2.5 2.5 0 1 1-.01 0z' },
    { label: 'match of neighbours', symbol: 'graph-match', path: 'M1 8h14' },
    { label: 'loop: a match with an earlier part', symbol: 'graph-loop', path: 'M1 11Q8 2 15 11' },
    { label: 'not used: it disagrees', symbol: 'graph-unused', path: 'M1 8h14' },
  ],
};

/** @return the legend of an overlay; null if it needs none */
export function overlayLegend(key: keyof Settings, title: string): HTMLElement | null {
  const entries = kEntries[key];
  if (!entries) return null;
  const items = entries.map(({ label, symbol, path }) => el('li', {}, drawn(symbol, path), label));
  return el('ul', { class: 'legend overlay-legend', 'data-legend': key, 'aria-label': `Legend of ${title}` }, ...items);
}

function drawn(symbol: string, path: string): SVGElement {
  const sign = document.createElementNS(kSvg, 'svg');
  sign.setAttribute('viewBox', '0 0 16 16');
  sign.setAttribute('class', `symbol ${symbol}`);
  sign.setAttribute('aria-hidden', 'true');
  const line = document.createElementNS(kSvg, 'path');
  line.setAttribute('d', path);
  sign.append(line);
  return sign;
}
