/** Builds elements. Texts always become text nodes, so names that robots chose cannot become markup. */

type Attributes = Record<string, string>;

export function el<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  attributes: Attributes = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[Tag] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/** Returns an element that index.html contains. */
export function byId<Type extends HTMLElement>(id: string, type: new () => Type): Type {
  const element = document.getElementById(id);
  if (!(element instanceof type)) throw new Error(`the page has no #${id} of type ${type.name}`);
  return element;
}

/** Writes only changes, because assistive technology announces every write. */
export function setText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export interface Row {
  element: HTMLElement;
}

/** A list of rows that are kept, moved or removed by key, so that focus and hover survive an update. */
export class KeyedList<Item, ItemRow extends Row> {
  private readonly rows = new Map<string, ItemRow>();

  constructor(
    private readonly parent: HTMLElement,
    private readonly keyOf: (item: Item) => string,
    private readonly create: (item: Item) => ItemRow,
    private readonly update: (row: ItemRow, item: Item) => void,
  ) {}

  show(items: Item[]): void {
    const keys = new Set(items.map(this.keyOf));
    for (const [key, row] of this.rows) {
      if (keys.has(key)) continue;
      row.element.remove();
      this.rows.delete(key);
    }
    items.forEach((item, index) => this.place(this.rowOf(item), index));
  }

  private rowOf(item: Item): ItemRow {
    const key = this.keyOf(item);
    let row = this.rows.get(key);
    if (!row) {
      row = this.create(item);
      this.rows.set(key, row);
    }
    this.update(row, item);
    return row;
  }

  private place(row: ItemRow, index: number): void {
    const there = this.parent.children.item(index);
    if (there !== row.element) this.parent.insertBefore(row.element, there);
  }
}
