/** Tools that work on the map, one at a time: a button for each, and a card next to the map while it is open. */
import { byId, el, setText } from '../dom';
import type { Keys } from '../keys';
import { makeDraggable } from './card_drag';

/** A tool without a button of its own among the tools. */
export interface ToolCard {
  id: string;
  title: string;
  /** The tool works without a map. */
  withoutMap?: true;
  /** Fills the card, and listens to the map until the signal aborts. */
  open(card: HTMLElement, signal: AbortSignal): void;
}

/** A tool with a button: #tool-ID. */
export interface Tool extends ToolCard {
  key: string;
  /** For the list of shortcuts: "measures a distance". */
  does: string;
  /** The path of its icon in a square of 16. */
  icon: string;
}

export class Toolbox {
  private readonly fields = {
    /** Container of the buttons. */
    bar: byId('toolbar', HTMLElement),
    card: byId('tool', HTMLElement),
    head: byId('tool-head', HTMLElement),
    title: byId('tool-title', HTMLElement),
    body: byId('tool-body', HTMLElement),
    close: byId('tool-close', HTMLButtonElement),
  };
  private readonly buttons = new Map<ToolCard, HTMLButtonElement>();
  /** The button of the open tool; null: none is open. */
  private opener: HTMLButtonElement | null = null;
  private leave = new AbortController();

  constructor(
    private readonly keys: Keys,
    /** Whether a map is shown. */
    private readonly hasMap: () => boolean,
    stage: HTMLElement,
  ) {
    makeDraggable(this.fields.card, this.fields.head, stage);
    this.fields.close.addEventListener('click', () => this.close());
    keys.bind({ key: 'Escape', does: 'closes the tool that is open', run: () => this.close() });
  }

  add(tool: Tool): void {
    const title = `${tool.title} (${tool.key})`;
    const icon = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    icon.setAttribute('viewBox', '0 0 16 16');
    icon.setAttribute('aria-hidden', 'true');
    const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
    path.setAttribute('d', tool.icon);
    icon.append(path);
    const button = el('button', { type: 'button', id: `tool-${tool.id}`, title, 'aria-pressed': 'false' }, icon);
    button.setAttribute('aria-label', tool.title);
    button.addEventListener('click', () => this.toggle(tool));
    this.buttons.set(tool, button);
    this.fields.bar.append(button);
    this.keys.bind({ key: tool.key, does: tool.does, run: () => this.toggle(tool) });
  }

  /** Closes the tool: its session is closed, or another tool opens. */
  close(): void {
    const { opener } = this;
    if (!opener) return;
    opener.setAttribute('aria-pressed', 'false');
    this.opener = null;
    this.leave.abort();
    if (this.fields.card.contains(document.activeElement)) opener.focus();
    this.fields.body.replaceChildren();
    this.fields.card.hidden = true;
  }

  /**
   * Opens the tool, replacing another one, or closes it.
   *
   * @param opener the button of the tool
   */
  toggle(tool: ToolCard, opener = this.buttons.get(tool)): void {
    const wasOpen = this.opener === opener;
    this.close();
    if (!opener || wasOpen || !(tool.withoutMap || this.hasMap())) return;
    this.opener = opener;
    this.leave = new AbortController();
    opener.setAttribute('aria-pressed', 'true');
    setText(this.fields.title, tool.title);
    this.fields.card.hidden = false;
    this.fields.card.dataset['tool'] = tool.id;
    tool.open(this.fields.body, this.leave.signal);
  }
}
