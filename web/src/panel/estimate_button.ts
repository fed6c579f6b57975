/** The button that has the poses of a recorded session estimated. For operators. */
import { estimateSession } from '../api/localization';
import type { Session } from '../api/types';
import { el } from '../dom';
import { FormDialog } from '../sessions/form_dialog';

const kWhen = 'For a map that is torn because the robots sent odometry, which drifts, as their poses.';
const kConsequence =
  'The server estimates where each scan was taken and makes the map again. The session cannot go back to the poses that the robots sent; its log keeps them as odometry.';

export class EstimateButton {
  private readonly button = el('button', { type: 'button', class: 'wide-button' }, 'Estimate poses\u2026');
  private session: Session | null = null;

  /** @param estimated called when the server has taken the request: the session has another id from now on */
  constructor(
    place: HTMLElement,
    private readonly estimated: () => void,
  ) {
    this.button.addEventListener('click', () => this.ask());
    place.append(this.button);
  }

  show(session: Session): void {
    this.session = session;
    this.button.hidden = session.robots.every(({ localization }) => localization !== null);
  }

  private ask(): void {
    if (!this.session) return;
    const { name } = this.session;
    const dialog = new FormDialog(
      { title: 'Estimate poses?', submit: 'Estimate', busy: 'Copying the log\u2026', destructive: true },
      [el('p', {}, el('strong', { dir: 'auto' }, name)), el('p', {}, kWhen), el('p', {}, kConsequence)],
      async (signal) => {
        await estimateSession(name, signal);
        this.estimated();
      },
    );
    dialog.element.addEventListener('close', () => dialog.element.remove());
    dialog.open(dialog.cancel);
  }
}
