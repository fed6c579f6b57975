/** One tab stop for a whole list: arrow keys move between its rows. */
export interface Stop {
  link: HTMLElement;
  /** Selector of the row's button, reached by Tab from the row's link only. */
  others: HTMLElement[];
}

export class Roving {
  private stops: Stop[] = [];
  private current: HTMLElement | null = null;

  /** @param leave called for Up on the first row: moves to the search field */
  constructor(
    private readonly list: HTMLElement,
    private readonly leave: () => void,
  ) {
    list.addEventListener('keydown', (event) => this.press(event));
    list.addEventListener('focusin', ({ target }) => {
      const stop = this.stops.find(({ link, others }) => link === target || others.some((each) => each === target));
      if (stop) this.settleOn(stop.link);
    });
  }

  /** @param chosen the tab stop before a row had the focus */
  show(stops: Stop[], chosen: HTMLElement | null): void {
    this.stops = stops;
    const isThere = (link: HTMLElement | null): boolean => stops.some((stop) => stop.link === link);
    const link = isThere(this.current) ? this.current : isThere(chosen) ? chosen : (stops[0]?.link ?? null);
    this.settleOn(link);
  }

  focus(index: number): boolean {
    const stop = this.stops[Math.min(Math.max(index, 0), this.stops.length - 1)];
    stop?.link.focus();
    return stop !== undefined;
  }

  private settleOn(link: HTMLElement | null): void {
    this.current = link;
    for (const stop of this.stops) {
      const index = stop.link === link ? 0 : -1;
      for (const each of [stop.link, ...stop.others]) if (each.tabIndex !== index) each.tabIndex = index;
    }
  }

  private press(event: KeyboardEvent): void {
    if (event.altKey || event.ctrlKey || event.metaKey || event.shiftKey) return;
    const at = this.stops.findIndex(({ link }) => link === this.current);
    switch (event.key) {
      case 'ArrowDown':
        this.focus(at + 1);
        break;
      case 'ArrowUp':
        if (at > 0) this.focus(at - 1);
        else this.leave();
        break;
      case 'Home':
        this.focus(0);
        break;
      case 'End':
        this.focus(this.stops.length - 1);
        break;
      case 'Delete':
        if (this.list.contains(document.activeElement)) this.stops[at]?.others[0]?.click();
        break;
      default:
        return;
    }
    event.preventDefault();
  }
}
