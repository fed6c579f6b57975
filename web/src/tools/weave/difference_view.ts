/** What the two sides disagree in: numbers beside the map, a picture on it, and what its colours mean. */
import ImageLayer from 'ol/layer/Image';
import ImageStatic from 'ol/source/ImageStatic';
import { fetchDifference, fetchDifferencePicture, type Difference, type DifferenceName } from '../../api/difference';
import { el } from '../../dom';
import * as format from '../../format';
import { kOrder } from '../../map/order';
import { kProjection } from '../../map/projection';
import { shownWeave, type ToolContext } from '../context';
import { button, checkbox, choice, figures } from '../fields';
import { NewestOnly } from '../newest_only';
import type { Outcome } from '../outcome';
import { saveBlob } from '../save_file';

/** In the order of the legend; the style sheet has the server's colours. */
const kLegend: [name: DifferenceName, label: string][] = [
  ['occupied_free', 'obstacle only in the map'],
  ['free_occupied', 'obstacle only in the weave'],
  ['only_a', 'seen only in the map'],
  ['only_b', 'seen only in the weave'],
  ['both_occupied', 'obstacle in both'],
  ['both_free', 'free in both'],
  ['undecided', 'not sure in one or both'],
];

export class DifferenceView {
  private readonly onMap = checkbox('difference', true);
  private readonly numbers = el('div');
  private readonly save = button('Save the picture', () => this.keep());
  readonly element = el(
    'section',
    { class: 'tool-difference', 'aria-label': 'Difference' },
    choice('Difference on the map', this.onMap),
    this.numbers,
    el('div', { class: 'tool-buttons' }, button('Compare again', () => this.compare(this.weave)), this.save),
  );
  private readonly layer = new ImageLayer<ImageStatic>({ zIndex: kOrder.difference });
  private readonly asking: NewestOnly;
  private weave: string | null = null;
  private png: Blob | null = null;
  private address: string | null = null;

  constructor(
    private readonly context: ToolContext,
    signal: AbortSignal,
    private readonly outcome: Outcome,
  ) {
    this.asking = new NewestOnly(
      signal,
      (busy) => this.element.setAttribute('aria-busy', String(busy)),
      (error) => {
        this.forget();
        this.outcome.complain(error);
      },
    );
    this.element.hidden = true;
    context.map.addLayer(this.layer);
    this.onMap.addEventListener('change', () => this.layer.setVisible(this.onMap.checked));
    signal.addEventListener('abort', () => {
      this.forget();
      context.map.removeLayer(this.layer);
    });
  }

  /** @param weave that is to be compared with what is shown; null: none */
  compare(weave: string | null): void {
    const session = this.context.session();
    const shown = this.context.picture.main;
    this.weave = weave;
    this.element.hidden = weave === null;
    if (weave === null || !session || !shown) {
      this.asking.stop();
      return this.forget();
    }
    const query = { layer: shown.layer, weave: shownWeave(this.context), with: weave };
    this.asking.run(async (signal) => {
      const [difference, { png, extent }] = await Promise.all([
        fetchDifference(session.name, query, signal),
        fetchDifferencePicture(session.name, query, signal),
      ]);
      this.show(difference);
      this.draw(png, extent);
    });
  }

  private show({ areas, agreement, meanDifference }: Difference): void {
    const totals: [string, string][] = [
      ['Agreement', agreement === null ? 'nothing in common' : `${format.decimal(100 * agreement, 1)} %`],
    ];
    if (meanDifference !== null) totals.push(['Mean difference', `${format.decimal(100 * meanDifference, 1)} %`]);
    const rows = kLegend.map(([name, label]) =>
      el(
        'tr',
        {},
        el('th', { scope: 'row' }, el('span', { class: `sample difference-${name}` }), label),
        el('td', { class: 'numeric' }, `${format.decimal(areas[name], 2)} m\u00b2`),
      ),
    );
    const caption = el('caption', { class: 'unseen' }, 'Areas by what the two maps say');
    this.numbers.replaceChildren(figures(totals), el('table', {}, caption, el('tbody', {}, ...rows)));
  }

  private draw(png: Blob, imageExtent: [number, number, number, number]): void {
    this.png = png;
    const before = this.address;
    const url = (this.address = URL.createObjectURL(png));
    this.layer.setSource(new ImageStatic({ url, imageExtent, projection: kProjection, interpolate: false }));
    if (before !== null) URL.revokeObjectURL(before);
  }

  private forget(): void {
    this.numbers.replaceChildren();
    this.layer.setSource(null);
    this.png = null;
    if (this.address !== null) URL.revokeObjectURL(this.address);
    this.address = null;
  }

  private keep(): void {
    if (this.png) saveBlob(this.png, `${this.context.session()?.name ?? 'map'}-difference.png`);
  }
}
