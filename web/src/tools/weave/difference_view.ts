/** The differences between the two sides: numbers next to the map, a picture on it, and its legend. */
import ImageLayer from 'ol/layer/Image';
import ImageStatic from 'ol/source/ImageStatic';
import {
  fetchDifference,
  fetchDifferencePicture,
  type Difference,
  type DifferenceName,
  type DifferencePicture,
  type DifferenceQuery,
} from '../../api/difference';
import { el, setText } from '../../dom';
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
  ['only_a', 'known only in the map'],
  ['only_b', 'known only in the weave'],
  ['both_occupied', 'obstacle in both'],
  ['both_free', 'free in both'],
  ['undecided', 'undecided in one or both'],
];

export class DifferenceView {
  private readonly onMap = checkbox('difference', false);
  private readonly numbers = el('div');
  private readonly warning = el('p', { class: 'quiet' });
  private readonly save = button('Save picture', () => this.keep());
  readonly element = el(
    'section',
    { class: 'tool-difference', 'aria-label': 'Difference' },
    choice('Difference on the map', this.onMap),
    this.numbers,
    this.warning,
    el(
      'div',
      { class: 'tool-buttons' },
      button('Compare again', () => this.compare(this.weave)),
      this.save,
    ),
  );
  private readonly layer = new ImageLayer<ImageStatic>({ zIndex: kOrder.difference });
  private readonly task: NewestOnly;
  private readonly saving: NewestOnly;
  private weave: string | null = null;
  private address: string | null = null;

  constructor(
    private readonly context: ToolContext,
    signal: AbortSignal,
    private readonly outcome: Outcome,
  ) {
    this.task = new NewestOnly(
      signal,
      (busy) => this.element.setAttribute('aria-busy', String(busy)),
      (error) => {
        this.forget();
        this.outcome.complain(error);
      },
    );
    this.saving = new NewestOnly(
      signal,
      () => {},
      (error) => outcome.complain(error),
    );
    this.element.hidden = true;
    context.map.addLayer(this.layer);
    this.onMap.addEventListener('change', () => this.compare(this.weave));
    signal.addEventListener('abort', () => {
      this.forget();
      context.map.removeLayer(this.layer);
    });
  }

  /** @param weave to compare with the shown map; null: none */
  compare(weave: string | null): void {
    const session = this.context.session();
    this.weave = weave;
    this.element.hidden = weave === null;
    const isPast = shownWeave(this.context) !== null;
    const past = 'The map is of an earlier moment, the weave of all scans: later scans count as differences.';
    setText(this.warning, isPast ? past : '');
    this.warning.hidden = !isPast;
    const query = this.query();
    if (!session || !query) {
      this.task.stop();
      return this.forget();
    }
    this.task.run(async (signal) => {
      const [difference, picture] = await Promise.all([
        fetchDifference(session.name, query, signal),
        this.onMap.checked ? fetchDifferencePicture(session.name, query, signal) : null,
      ]);
      this.show(difference);
      this.draw(picture);
    });
  }

  /** The shown map that is compared with the weave; null: none. */
  private query(): DifferenceQuery | null {
    const shown = this.context.picture.main;
    if (this.weave === null || !shown) return null;
    return { layer: shown.layer, weave: shownWeave(this.context), with: this.weave };
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
    const caption = el('caption', { class: 'unseen' }, 'Areas by the values of the two maps');
    this.numbers.replaceChildren(figures(totals), el('table', {}, caption, el('tbody', {}, ...rows)));
  }

  private draw(picture: DifferencePicture | null): void {
    const before = this.address;
    this.address = picture && URL.createObjectURL(picture.png);
    const at = { imageExtent: picture?.extent ?? [], projection: kProjection, interpolate: false };
    this.layer.setSource(this.address === null ? null : new ImageStatic({ url: this.address, ...at }));
    if (before !== null) URL.revokeObjectURL(before);
  }

  private forget(): void {
    this.numbers.replaceChildren();
    this.draw(null);
  }

  private keep(): void {
    const session = this.context.session();
    const query = this.query();
    if (!session || !query) return;
    this.saving.run(async (signal) => {
      const { png } = await fetchDifferencePicture(session.name, query, signal);
      saveBlob(png, `${session.name}-difference.png`);
    });
  }
}
