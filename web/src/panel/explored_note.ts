/** Reports when robots have explored everything that they can reach. */
import { setText } from '../dom';

export class ExploredNote {
  private isHidden = false;

  constructor(private readonly line: HTMLElement) {}

  /** @param robots their names; none: hides the note */
  show(robots: string[]): void {
    setText(this.line, exploredText(robots));
    this.update();
  }

  /** Hides the note while the map of an earlier time is shown. */
  setHidden(isHidden: boolean): void {
    this.isHidden = isHidden;
    this.update();
  }

  private update(): void {
    this.line.hidden = this.isHidden || this.line.textContent === '';
  }
}

const kNamesMax = 3;

export function exploredText(robots: string[]): string {
  if (robots.length === 0) return '';
  const named = robots.slice(0, kNamesMax);
  const others = robots.length - named.length;
  const who = others > 0 ? [...named, `${others} more`] : named;
  const list = who.length > 1 ? `${who.slice(0, -1).join(', ')} and ${who.at(-1)}` : who.join('');
  return robots.length > 1 ? `${list} have explored all they can reach.` : `${list} has explored all it can reach.`;
}
