/** Plans a path from one place to another for a robot of a given size. */
import Feature from 'ol/Feature';
import LineString from 'ol/geom/LineString';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import { requestPlan, type Start, type PlannedPath } from '../api/plan';
import type { Point } from '../api/types';
import { el, setText } from '../dom';
import * as format from '../format';
import { kOrder } from '../map/order';
import { isTouch, pickSentence } from '../pointing';
import { shownWeave, type ToolContext } from './context';
import { saveBlob } from './save_file';
import { button, checkbox, choice, figures, labelled, numberInput } from './fields';
import { Marks } from './marks';
import { NewestOnly } from './newest_only';
import { Outcome } from './outcome';
import { pathStyle } from './path_style';
import { pickPlaces } from './pick_places';
import { StartSelect } from './start_select';
import type { Tool } from './toolbox';

/** Interval of checks whether the map has grown. */
const kWatchMs = 1_000;
const kBodyRadius = 0.15;

export function pathTool(context: ToolContext): Tool {
  return {
    id: 'path',
    title: 'Path',
    key: 'p',
    does: 'plans a path between two places',
    icon: 'M3 12.5h5.5a2.5 2.5 0 0 0 0-5h-2a2.5 2.5 0 0 1 0-5H13M11.5 1l1.5 1.5L11.5 4',
    open: (card, signal) => void new PathCard(context, card, signal),
  };
}

type End = 'from' | 'to';

const kLetters: Record<End, string> = { from: 'A', to: 'B' };

class PathCard {
  private readonly places: Record<End, Point | null> = { from: null, to: null };
  private readonly placeTexts: Record<End, HTMLElement> = { from: el('output'), to: el('output') };
  private next: End = 'from';
  private path: PlannedPath | null = null;
  private readonly start: StartSelect;
  private readonly bodyRadius = numberInput('body_radius', kBodyRadius, { min: 0, max: 5 });
  private readonly dangerCost = numberInput('danger_cost', 1, { min: 0, max: 1000 });
  private readonly allowUnknown = checkbox('allow_unknown', false);
  private readonly keepUp = checkbox('keep_up', false);
  private readonly result = el('div');
  private readonly outcome = new Outcome();
  private readonly line = new LineString([]);
  private readonly marks: Marks;
  private readonly task: NewestOnly;

  constructor(
    private readonly context: ToolContext,
    card: HTMLElement,
    private readonly signal: AbortSignal,
  ) {
    this.start = new StartSelect(context.robots);
    this.task = new NewestOnly(
      signal,
      (busy) => busy && this.outcome.report('Planning the path\u2026'),
      (error) => this.refuse(error),
    );
    this.drawPath();
    this.marks = new Marks(context, signal, (letter, place) => this.put(letter === kLetters.to ? 'to' : 'from', place));
    this.fill(card);
    pickPlaces(context.map, context.target, signal, (place) => this.pick(place));
    const watch = setInterval(() => this.watch(), kWatchMs);
    signal.addEventListener('abort', () => clearInterval(watch));
    this.guide();
  }

  private drawPath(): void {
    const { map, theme } = this.context;
    const layer = new VectorLayer({
      source: new VectorSource({ features: [new Feature(this.line)] }),
      style: (feature) => pathStyle(feature, theme().path, theme().halo),
      zIndex: kOrder.paths,
    });
    map.addLayer(layer);
    this.signal.addEventListener('abort', () => map.removeLayer(layer));
  }

  private fill(card: HTMLElement): void {
    const form = el(
      'form',
      { class: 'tool-form' },
      labelled('From', this.start.element),
      this.placeRow('from', 'Choose the start'),
      this.placeRow('to', 'Choose the end'),
      labelled('Body radius, m', this.bodyRadius),
      labelled('Cost of danger', this.dangerCost),
      choice('Allow unknown ground', this.allowUnknown),
      choice('Replan as the map grows', this.keepUp),
      el('button', { class: 'tool-button primary' }, 'Plan path'),
    );
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.submit();
    });
    form.addEventListener('change', ({ target }) => {
      if (target === this.start.element) this.chooseStart();
      if (form.checkValidity()) this.submit();
    });
    card.append(this.outcome.element, this.result, form);
  }

  private placeRow(end: End, label: string): HTMLElement {
    const again = button('Choose', () => this.choose(end), { 'aria-label': label });
    const letter = el('span', { class: 'tool-letter' }, kLetters[end]);
    return el('div', { class: 'tool-place' }, letter, this.placeTexts[end], again);
  }

  private choose(end: End): void {
    if (end === 'from') this.start.choosePlace();
    this.next = end;
    this.guide();
    this.context.target.focus();
  }

  private chooseStart(): void {
    if (this.start.robot === null) this.next = this.places.from ? 'to' : 'from';
    else this.next = 'to';
    this.bodyRadius.value = String(this.start.bodyRadius ?? this.bodyRadius.value);
    this.marks.put(kLetters.from, this.start.robot === null ? this.places.from : null);
    this.guide();
  }

  private pick(place: Point): void {
    const end = this.next;
    this.next = 'to';
    this.put(end, place);
  }

  /** A place was picked, or dragged. */
  private put(end: End, place: Point): void {
    this.places[end] = place;
    this.marks.put(kLetters[end], place);
    this.submit();
  }

  /** Shows the current input, and the next step. */
  private guide(): void {
    const { from, to } = this.places;
    setText(this.placeTexts.from, this.start.robot ?? (from ? placeText(from) : 'not chosen yet'));
    setText(this.placeTexts.to, to ? placeText(to) : 'not chosen yet');
    const wanted = this.next === 'from' ? 'start' : 'end';
    const known = this.startPlace !== null && to !== null && this.next === 'to';
    if (!known) this.outcome.report(pickSentence(`the ${wanted} of the path`));
  }

  private get startPlace(): Start | null {
    return this.start.robot === null ? this.places.from : { robot: this.start.robot };
  }

  private submit(): void {
    this.guide();
    const session = this.context.session();
    const from = this.startPlace;
    const { to } = this.places;
    if (!session || !from || !to) return;
    const request = {
      from,
      to,
      allowUnknown: this.allowUnknown.checked,
      bodyRadius: this.bodyRadius.valueAsNumber,
      dangerCost: this.dangerCost.valueAsNumber,
    };
    this.task.run(async (signal) => {
      this.show(await requestPlan(session.name, shownWeave(this.context), request, signal));
    });
  }

  private show(path: PlannedPath): void {
    this.path = path;
    this.line.setCoordinates(path.points);
    const rows: [string, string][] = [
      ['Length', format.distance(path.length)],
      [`Cost, danger weighted ${1 + this.dangerCost.valueAsNumber}-fold`, format.decimal(path.cost, 2)],
    ];
    const save = button('Save the path (GeoJSON)', () => savePath(this.context.session()?.name ?? 'map', path));
    this.result.replaceChildren(figures(rows), save);
    this.outcome.report(`Path found. Drag its ends, or ${isTouch() ? 'tap' : 'click'} another end.`);
  }

  private refuse(error: unknown): void {
    this.path = null;
    this.line.setCoordinates([]);
    this.result.replaceChildren();
    this.outcome.complain(error);
  }

  /** A path is valid for the revision of the map on which it was planned. */
  private watch(): void {
    const session = this.context.session();
    const grown = this.path !== null && session !== null && session.revision > this.path.revision;
    if (!grown || this.task.busy || shownWeave(this.context) !== null) return;
    if (this.keepUp.checked) this.submit();
    else this.outcome.report('The map has grown since this path was planned.');
  }
}

/** GeoJSON like the server's plan: metres in the map frame. */
function savePath(session: string, { points, length, cost, revision }: PlannedPath): void {
  const geometry = { type: 'LineString', coordinates: points };
  const feature = { type: 'Feature', frame_id: 'map', units: 'm', revision, properties: { length, cost }, geometry };
  saveBlob(new Blob([JSON.stringify(feature)], { type: 'application/geo+json' }), `${session}-path.geojson`);
}

function placeText([x, y]: Point): string {
  return `x ${format.decimal(x, 2)}, y ${format.decimal(y, 2)} m`;
}
