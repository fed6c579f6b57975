/** Form fields of the tools, each with its label. */
import { el } from '../dom';

let made = 0;

/** An element id for a label to refer to. */
function freshId(): string {
  made += 1;
  return `field-${made}`;
}

/** A label next to its control. */
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
  /** Placeholder, for a field that may be empty. */
  empty?: string;
}

export function numberInput(name: string, value: number | null, { min, max, empty }: NumberLimits): HTMLInputElement {
  const input = el('input', { type: 'number', name, step: 'any', min: String(min), max: String(max) });
  if (value !== null) input.value = String(value);
  if (empty === undefined) input.required = true;
  else input.placeholder = empty;
  return input;
}

/** Returns the number in the field, or null if the field is empty. Only a field with a placeholder may be empty. */
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

/** Numbers with their names, as a list that screen readers can read. */
export function figures(rows: [name: string, value: string][]): HTMLElement {
  return el(
    'dl',
    { class: 'tool-figures' },
    ...rows.map(([name, value]) => el('div', {}, el('dt', {}, name), el('dd', { class: 'numeric' }, value))),
  );
}
