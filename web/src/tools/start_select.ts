/** Selection of a path's start: a place on the map, or a robot's position. */
import type { Robot } from '../api/types';
import { el } from '../dom';

/** A value that is no valid robot name. */
const kPlace = '';

export class StartSelect {
  readonly element = el('select', { name: 'start' });

  /** @param robots the current robots; called whenever the list opens */
  constructor(private readonly robots: () => Robot[]) {
    this.fill();
    for (const event of ['focus', 'pointerdown']) this.element.addEventListener(event, () => this.fill());
  }

  /** The chosen robot; null: a place on the map. */
  get robot(): string | null {
    return this.element.value === kPlace ? null : this.element.value;
  }

  choosePlace(): void {
    this.element.value = kPlace;
  }

  /** The robot's body radius, metres; null where unknown. */
  get bodyRadius(): number | null {
    return this.robots().find(({ name }) => name === this.robot)?.bodyRadius ?? null;
  }

  private fill(): void {
    const names = this.robots().flatMap(({ name, pose }) => (pose ? [name] : []));
    const there = [...this.element.options].slice(1).map(({ value }) => value);
    if (this.element.options.length > 0 && JSON.stringify(names) === JSON.stringify(there)) return;
    const chosen = this.element.value;
    this.element.replaceChildren(
      el('option', { value: kPlace }, 'A place on the map'),
      ...names.map((name) => el('option', { value: name, dir: 'auto' }, `Robot ${name}`)),
    );
    this.element.value = names.includes(chosen) ? chosen : kPlace;
  }
}
