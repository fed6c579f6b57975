/** The button that turns localize-only mode of the open session on or off. For operators. */
import { changeMode } from '../api/localization';
import type { Session } from '../api/types';
import { el, setText } from '../dom';
import { NewestOnly } from '../tools/newest_only';
import { Outcome } from '../tools/outcome';

export class ModeButton {
  private readonly button = el('button', { type: 'button', class: 'wide-button' });
  private readonly outcome = new Outcome();
  private readonly task: NewestOnly;
  private session: Session | null = null;

  /** @param changed called when the server has changed the mode of the open session */
  constructor(
    place: HTMLElement,
    private readonly changed: (isLocalizeOnly: boolean) => void,
  ) {
    this.task = new NewestOnly(
      new AbortController().signal,
      (busy) => this.outcome.report(busy ? 'Changing the mode\u2026' : ''),
      (error) => this.outcome.complain(error),
    );
    this.button.addEventListener('click', () => this.change());
    place.append(this.button, this.outcome.element);
  }

  show(session: Session): void {
    if (session.id !== this.session?.id) this.task.stop();
    this.session = session;
    setText(this.button, session.isLocalizeOnly ? 'Continue mapping' : 'Localize only');
  }

  private change(): void {
    const { session } = this;
    if (!session || this.task.busy) return;
    const wanted = !session.isLocalizeOnly;
    this.task.run(async (signal) => {
      await changeMode(session.name, wanted, signal);
      signal.throwIfAborted();
      this.changed(wanted);
    });
  }
}
