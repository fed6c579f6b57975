/** Plans a coverage path over the free ground of a region. */
import { requestCoverage, type Coverage } from '../api/coverage';
import type { Start } from '../api/plan';
import type { Point } from '../api/types';
import { el, setText } from '../dom';
import * as format from '../format';
import { isTouch, pickSentence } from '../pointing';
import { shownWeave, type ToolContext } from './context';
import { CoverageLayer } from './coverage_layer';
import { button, figures, labelled, numberInput, numberOf, selectOf } from './fields';
import { Marks } from './marks';
import { NewestOnly } from './newest_only';
import { Outcome } from './outcome';
import { pickPlaces } from './pick_places';
import { Region, type Shape } from './region';
import { StartSelect } from './start_select';
import type { Tool } from './toolbox';

const kBodyRadius = 0.15;
const kShapes = [
  ['everything', 'All free ground'],
  ['box', 'A box'],
  ['polygon', 'A polygon'],
] as const;
const kStartLetter = 'S';

export function coverageTool(context: ToolContext): Tool {
  return {
    id: 'coverage',
    title: 'Coverage',
    key: 'c',
    does: 'plans a coverage path over the free ground of a region',
    icon: 'M2.5 3h11v3.3h-11v3.4h11V13h-11',
    open: (card, signal) => void new CoverageCard(context, card, signal),
  };
}

class CoverageCard {
  private startPlace: Point | null = null;
  private pickingStart = false;
  private readonly region: Region;
  private readonly shape = selectOf('region', kShapes);
  private readonly start: StartSelect;
  private readonly startText = el('output');
  private readonly bodyRadius = numberInput('body_radius', kBodyRadius, { min: 0, max: 5 });
  private readonly spacing = numberInput('spacing', null, { min: 0, max: 10, empty: 'two body radii' });
  private readonly close = button('Close the outline', () => this.endOutline());
  private readonly redraw = button('Draw again', () => this.beginOutline());
  private readonly find = el('button', { class: 'tool-button primary' }, 'Plan path');
  private readonly cancel = button('Cancel', () => this.giveUp());
  private readonly result = el('div');
  private readonly outcome = new Outcome();
  private readonly layer: CoverageLayer;
  private readonly marks: Marks;
  private readonly task: NewestOnly;

  constructor(
    private readonly context: ToolContext,
    card: HTMLElement,
    signal: AbortSignal,
  ) {
    this.start = new StartSelect(context.robots);
    this.layer = new CoverageLayer(context, signal);
    this.region = new Region(context, signal);
    this.marks = new Marks(context, signal, (_letter, place) => this.putStart(place));
    this.task = new NewestOnly(
      signal,
      (busy) => this.showBusy(busy),
      (error) => this.refuse(error),
    );
    const only = context.robots().filter(({ pose }) => pose);
    if (only.length === 1 && only[0]) this.start.element.value = only[0].name;
    this.fill(card);
    this.chooseStart();
    pickPlaces(context.map, context.target, signal, (place) => this.pick(place));
    this.cancel.hidden = true;
  }

  private fill(card: HTMLElement): void {
    const form = el(
      'form',
      { class: 'tool-form' },
      labelled('Region', this.shape),
      el('div', { class: 'tool-buttons' }, this.close, this.redraw),
      labelled('Start', this.start.element),
      el(
        'div',
        { class: 'tool-place' },
        el('span', { class: 'tool-letter' }, kStartLetter),
        this.startText,
        button('Choose', () => this.beginStart(), { 'aria-label': 'Choose the start' }),
      ),
      labelled('Body radius, m', this.bodyRadius),
      labelled('Row gap, m', this.spacing),
      el('div', { class: 'tool-buttons' }, this.find, this.cancel),
    );
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.submit();
    });
    this.shape.addEventListener('change', () => this.beginOutline());
    this.start.element.addEventListener('change', () => this.chooseStart());
    card.append(this.outcome.element, this.result, form);
  }

  private beginOutline(): void {
    this.pickingStart = false;
    this.region.begin((kShapes.find(([shape]) => shape === this.shape.value)?.[0] ?? 'everything') satisfies Shape);
    this.layer.show(null);
    this.result.replaceChildren();
    this.guide();
  }

  private endOutline(): void {
    this.region.close();
    this.guide();
  }

  private beginStart(): void {
    this.start.choosePlace();
    this.pickingStart = true;
    this.guide();
    this.context.target.focus();
  }

  private chooseStart(): void {
    this.bodyRadius.value = String(this.start.bodyRadius ?? this.bodyRadius.value);
    this.pickingStart = this.start.robot === null && this.startPlace === null;
    this.marks.put(kStartLetter, this.start.robot === null ? this.startPlace : null);
    this.guide();
  }

  private pick(place: Point): void {
    if (this.pickingStart) this.putStart(place);
    else if (this.region.drawing) this.region.add(place);
    this.guide();
  }

  private putStart(place: Point): void {
    this.startPlace = place;
    this.pickingStart = false;
    this.marks.put(kStartLetter, place);
    this.guide();
  }

  /** Shows the current input, and the next step. */
  private guide(): void {
    const place = this.startPlace;
    const chosen = place ? `x ${format.decimal(place[0], 2)}, y ${format.decimal(place[1], 2)} m` : 'not chosen yet';
    setText(this.startText, this.start.robot ?? chosen);
    this.close.hidden = !(this.region.drawing && this.shape.value === 'polygon');
    this.close.disabled = !this.region.closable;
    this.redraw.hidden = this.region.outline === null;
    this.outcome.report(this.advice());
  }

  private advice(): string {
    if (this.pickingStart) return pickSentence('the start of the path');
    if (!this.region.drawing) return '';
    if (this.shape.value === 'box') return pickSentence('two corners of the box');
    const close = isTouch() ? 'A double tap closes it.' : 'A double click, or Enter twice, closes it.';
    return `${pickSentence('the corners of the polygon')} ${close}`;
  }

  private submit(): void {
    const session = this.context.session();
    const start: Start | null = this.start.robot === null ? this.startPlace : { robot: this.start.robot };
    if (this.region.closable) this.endOutline();
    if (!session || !start || this.region.drawing) {
      return this.outcome.complain(new Error(this.advice() || 'Choose the start of the path'));
    }
    const request = {
      start,
      region: this.region.outline,
      bodyRadius: this.bodyRadius.valueAsNumber,
      spacing: numberOf(this.spacing),
    };
    this.task.run(async (signal) => {
      this.show(await requestCoverage(session.name, shownWeave(this.context), request, signal));
    });
  }

  private giveUp(): void {
    this.task.stop();
    this.outcome.report('Cancelled.');
    this.find.focus();
  }

  private showBusy(busy: boolean): void {
    this.cancel.hidden = !busy;
    if (busy) this.outcome.report('Planning the path\u2026');
  }

  private show(coverage: Coverage): void {
    this.layer.show(coverage);
    this.result.replaceChildren(
      figures([
        ['Covered', `${format.decimal(100 * coverage.fraction, 1)} %`],
        ['Free ground', squareMetres(coverage.freeArea)],
        ['Not reached (hatched)', squareMetres(coverage.unreachableArea)],
        ['Length', format.distance(coverage.length)],
      ]),
    );
    this.outcome.report('Path found.');
  }

  private refuse(error: unknown): void {
    this.layer.show(null);
    this.result.replaceChildren();
    this.outcome.complain(error);
  }
}

function squareMetres(area: number): string {
  return `${format.decimal(area, area >= 100 ? 0 : 2)} m\u00b2`;
}
