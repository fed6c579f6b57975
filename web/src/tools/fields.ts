/** Fields of the tools' forms, each with its label. */
import { el } from '../dom';

let made = 0;

/** A name for a label to point at. */
function freshId(): string {
  made += 1;
  return `field-${made}`;
}

/** A label beside what it is for. */
export function labelled(label: string, control: HTMLElement): HTMLElement {
  if (control.id === '') control.id = freshId();
  return el('div', { class: 'tool-row' }, el('label', { for: control.id }, label), control);
}

export function choice(label: string, box: HTMLInputElement): HTMLElement {
  return el('label', { class: 'choice' }, box, label);
}

export interface NumberLimits {
  min: number;
  max: number;
  /** Empty is an answer, too: what stands here then. */
  empty?: string;
}

export function numberInput(name: string, value: number | null, { min, max, empty }: NumberLimits): HTMLInputElement {
  const input = el('input', { type: 'number', name, step: 'any', min: String(min), max: String(max) });
  if (value !== null) input.value = String(value);
  if (empty === undefined) input.required = true;
  else input.placeholder = empty;
  return input;
}

/** Null when it is empty, which it may be only where it was given leave to. */
export function numberOf(input: HTMLInputElement): number | null {
  return input.value === '' ? null : input.valueAsNumber;
}

export function checkbox(name: string, checked: boolean): HTMLInputElement {
  const box = el('input', { type: 'checkbox', name });
  box.checked = checked;
  return box;
}

export type Options = readonly (readonly [value: string, label: string])[];

export function selectOf(name: string, options: Options): HTMLSelectElement {
  return el('select', { name }, ...options.map(([value, label]) => el('option', { value, dir: 'auto' }, label)));
}

export function button(label: string, run: () => void, attributes: Record<string, string> = {}): HTMLButtonElement {
  const made = el('button', { type: 'button', class: 'tool-button', ...attributes }, label);
  made.addEventListener('click', run);
  return made;
}

/** Numbers with their names, as a list for the eyes and for screen readers. */
export function figures(rows: [name: string, value: string][]): HTMLElement {
  return el(
    'dl',
    { class: 'tool-figures' },
    ...rows.map(([name, value]) => el('div', {}, el('dt', {}, name), el('dd', { class: 'numeric' }, value))),
  );
}
