/** Asks once more before a session goes for good. */
import { deleteSession } from '../api/manage';
import type { Session } from '../api/types';
import { el } from '../dom';
import { counted } from '../format';
import { FormDialog } from './form_dialog';

const kConsequence =
  'Its log of scans and all its maps are deleted for good. Robots that are online in it are disconnected.';

export interface DeleteEvents {
  /** The request is on its way: whoever watches the session may hear of its end before the answer comes. */
  asked(name: string): void;
  deleted(name: string, session: Session | null): void;
  /** It was refused, or the person no longer waits for the answer. */
  kept(name: string): void;
}

export class DeleteDialog {
  constructor(private readonly events: DeleteEvents) {}

  /** @param session null for one that the server cannot show */
  open(name: string, session: Session | null): void {
    let done = false;
    const dialog = new FormDialog(
      { title: 'Delete session?', submit: 'Delete', busy: 'Deleting\u2026', destructive: true },
      [
        el('p', {}, el('strong', { dir: 'auto' }, name), session ? ` \u00b7 ${contentOf(session)}` : ''),
        el('p', {}, kConsequence),
      ],
      async (signal) => {
        await this.delete(name, signal);
        done = true;
      },
    );
    // Only once it is closed can the focus go elsewhere.
    dialog.element.addEventListener('close', () => {
      dialog.element.remove();
      if (done) this.events.deleted(name, session);
    });
    dialog.open(dialog.cancel);
  }

  private async delete(name: string, signal: AbortSignal): Promise<void> {
    this.events.asked(name);
    try {
      await deleteSession(name, signal);
    } catch (error) {
      this.events.kept(name);
      throw error;
    }
  }
}

function contentOf({ scans, robots }: Session): string {
  return `${counted(scans, 'scan')}, ${counted(robots.length, 'robot')}`;
}
