/** Page-wide keyboard shortcuts, and the list of them for users. */
import { el } from './dom';

export interface Binding {
  /** A value of KeyboardEvent.key. */
  key: string;
  /** Description for the list. */
  does: string;
  run: () => void;
  /** Whether it applies now; if absent, it always does. */
  when?: () => boolean;
}

/** Keys of the map, which OpenLayers handles. */
const kMapKeys: [keys: string, does: string][] = [
  ['Arrow keys', 'move the map, when it has the focus'],
  ['+ \u2212', 'zoom'],
];

export class Keys {
  private readonly bindings = new Map<string, Binding>();
  private enabled: () => boolean = () => true;

  constructor() {
    document.addEventListener('keydown', (event) => this.press(event));
  }

  bind(binding: Binding): void {
    if (this.bindings.has(binding.key)) throw new Error(`the key ${binding.key} has a meaning already`);
    this.bindings.set(binding.key, binding);
  }

  /**
   * @param enabled whether single-key shortcuts are on: people who dictate or have a tremor turn them off (WCAG 2.1.4)
   */
  enable(enabled: () => boolean): void {
    this.enabled = enabled;
  }

  /** Returns a table of all keys. */
  describe(): HTMLElement {
    const bound = [...this.bindings.values()].map(({ key, does }): [string, string] => [nameOf(key), does]);
    const rows = [...bound, ...kMapKeys].map(([keys, does]) =>
      el('div', {}, el('dt', {}, el('kbd', {}, keys)), el('dd', {}, does)),
    );
    return el('dl', { class: 'keys' }, ...rows);
  }

  private press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (event.target instanceof Element && isTypedInto(event.target, event.key)) return;
    if (document.querySelector('dialog[open]')) return;
    // Letters work the same with Caps Lock.
    const binding = this.bindings.get(event.key) ?? this.bindings.get(event.key.toLowerCase());
    if (!binding || binding.when?.() === false) return;
    if (event.key !== 'Escape' && !this.enabled()) return;
    event.preventDefault();
    binding.run();
  }
}

/** Whether the element handles the key: a text field, a list of choices, a button. */
function isTypedInto(element: Element, key: string): boolean {
  if (key === 'Escape') return false;
  if (element instanceof HTMLInputElement) {
    if (element.type === 'range') return false;
    return !['checkbox', 'radio'].includes(element.type) || key === ' ';
  }
  if (element instanceof HTMLTextAreaElement || element instanceof HTMLSelectElement) return true;
  return key === ' ' && element.matches('button, a, summary, [role=button]');
}

function nameOf(key: string): string {
  return key === ' ' ? 'Space' : key === 'Escape' ? 'Esc' : key;
}
