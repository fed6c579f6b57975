/** The colours of a layer and their meaning. */
import { el } from '../dom';
import type { LayerName } from '../layers/layers';

interface Entry {
  label: string;
  /** Class of the sample, which the style sheet colours. */
  sample: string;
}

const kUnknown: Entry = { label: 'unknown', sample: 'unknown' };

const kProbability: Entry[] = [{ label: 'free', sample: 'free' }, kUnknown, { label: 'occupied', sample: 'occupied' }];

const kEntries: Record<LayerName, Entry[]> = {
  occupancy: kProbability,
  sonar: kProbability,
  himm: [
    { label: 'counter 0', sample: 'counter-0' },
    { label: '5', sample: 'counter-5' },
    { label: '10', sample: 'counter-10' },
    { label: '15', sample: 'counter-15' },
    { label: 'unknown', sample: 'unknown' },
  ],
  classification: [
    { label: 'free', sample: 'class-free' },
    { label: 'occupied', sample: 'class-occupied' },
    { label: 'frontier', sample: 'class-frontier' },
    { label: 'danger', sample: 'class-danger' },
    { label: 'unexplored', sample: 'unknown' },
  ],
};

export function showLegend(list: HTMLElement, layer: LayerName): void {
  if (list.dataset['layer'] === layer) return;
  list.dataset['layer'] = layer;
  list.replaceChildren(
    ...kEntries[layer].map(({ label, sample }) => el('li', {}, el('span', { class: `sample ${sample}` }), label)),
  );
}
