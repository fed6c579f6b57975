/** Says where a robot is whose poses the server estimates: its next scan is searched for in the circle that the user picks. */
import Feature from 'ol/Feature';
import Circle from 'ol/geom/Circle';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import Fill from 'ol/style/Fill';
import Stroke from 'ol/style/Stroke';
import Style from 'ol/style/Style';
import { relocalize } from '../api/localization';
import type { Point } from '../api/types';
import { byId, el } from '../dom';
import * as format from '../format';
import { kOrder } from '../map/order';
import { pickSentence } from '../pointing';
import type { Theme } from '../theme';
import type { ToolContext } from './context';
import { button, labelled, numberInput } from './fields';
import { NewestOnly } from './newest_only';
import { Outcome } from './outcome';
import { pickPlaces } from './pick_places';
import type { ToolCard } from './toolbox';

/** Metres; the maximum is the server's. */
const kRadius = 5;
const kRadiusLimits = { min: 0.1, max: 1000 };
/** Opacity of the circle's area, in hexadecimal. */
const kOpacity = '33';

export function locateCard(context: ToolContext, robot: string): ToolCard {
  return {
    id: 'locate',
    title: `Say where ${robot} is`,
    open: (card, signal) => void new LocateCard(context, robot, card, signal),
  };
}

class LocateCard {
  private readonly radius = numberInput('radius', kRadius, kRadiusLimits);
  private readonly form = el('form', { class: 'tool-form' }, labelled('Radius, m', this.radius));
  private readonly again = button('Choose another place', () => this.pick());
  private readonly outcome = new Outcome();
  private readonly area = new Feature<Circle>();
  private readonly task: NewestOnly;
  private place: Point | null = null;
  /** Ends the choice of a place; null: a place is chosen. */
  private picking: AbortController | null = null;

  constructor(
    private readonly context: ToolContext,
    private readonly robot: string,
    card: HTMLElement,
    private readonly signal: AbortSignal,
  ) {
    this.task = new NewestOnly(
      signal,
      (busy) => busy && this.outcome.report('Sending the place\u2026'),
      (error) => this.outcome.complain(error),
    );
    this.drawArea();
    this.form.addEventListener('submit', (event) => {
      event.preventDefault();
      context.target.focus();
    });
    this.radius.addEventListener('input', () => this.draw());
    card.append(this.outcome.element, this.form, this.again);
    this.pick();
  }

  private drawArea(): void {
    const { map, theme } = this.context;
    const layer = new VectorLayer({
      source: new VectorSource({ features: [this.area] }),
      style: () => styleOf(theme()),
      zIndex: kOrder.marks,
      updateWhileAnimating: true,
      updateWhileInteracting: true,
    });
    map.addLayer(layer);
    this.signal.addEventListener('abort', () => map.removeLayer(layer));
  }

  /** Lets the user pick a place; until then the circle follows the pointer, or the crosshair of the keyboard. */
  private pick(): void {
    const { map, target } = this.context;
    const picking = (this.picking = new AbortController());
    const signal = AbortSignal.any([this.signal, picking.signal]);
    const view = map.getView();
    const followPointer = ({ coordinate }: { coordinate: number[] }): void => this.move(coordinate);
    const followKeys = (): void => {
      if (!byId('crosshair', HTMLElement).hidden) this.move(view.getCenter() ?? []);
    };
    this.again.hidden = true;
    this.outcome.report(pickSentence(`the place of ${this.robot}`));
    pickPlaces(map, target, signal, (place) => this.send(place));
    map.on('pointermove', followPointer);
    view.on('change:center', followKeys);
    signal.addEventListener('abort', () => {
      map.un('pointermove', followPointer);
      view.un('change:center', followKeys);
    });
    target.focus();
    followKeys();
  }

  private move([x, y]: number[]): void {
    if (this.task.busy || x === undefined || y === undefined) return;
    this.place = [x, y];
    this.draw();
  }

  private draw(): void {
    const isDrawn = this.place !== null && this.radius.checkValidity();
    this.area.setGeometry(isDrawn && this.place ? new Circle(this.place, this.radius.valueAsNumber) : undefined);
  }

  private send(near: Point): void {
    const session = this.context.session();
    if (!session || this.task.busy || !this.form.reportValidity()) return;
    this.move(near);
    const radius = this.radius.valueAsNumber;
    this.task.run(async (signal) => {
      await relocalize(session.name, { robot: this.robot, near, radius }, signal);
      this.picking?.abort();
      this.picking = null;
      this.again.hidden = false;
      this.outcome.report(`The next scan of ${this.robot} is searched for within ${format.roundLength(radius)}.`);
    });
  }
}

function styleOf({ accent }: Theme): Style {
  return new Style({
    fill: new Fill({ color: accent + kOpacity }),
    stroke: new Stroke({ color: accent, width: 2 }),
  });
}
