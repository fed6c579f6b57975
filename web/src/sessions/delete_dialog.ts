/** The dialog that confirms the deletion of a session. */
import { deleteSession } from '../api/manage';
import type { Session } from '../api/types';
import { el } from '../dom';
import { counted } from '../format';
import { FormDialog } from './form_dialog';

const kConsequence = 'Its log of scans and all its maps are deleted permanently. Its online robots are disconnected.';

export interface DeleteEvents {
  /** The request is being sent: live connections of the session may end before the answer arrives. */
  deleting(name: string): void;
  deleted(name: string, session: Session | null): void;
  /** The request was refused, or the user no longer waits for the answer. */
  notDeleted(name: string): void;
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
    // The focus can move only after the dialog has closed.
    dialog.element.addEventListener('close', () => {
      dialog.element.remove();
      if (done) this.events.deleted(name, session);
    });
    dialog.open(dialog.cancel);
  }

  private async delete(name: string, signal: AbortSignal): Promise<void> {
    this.events.deleting(name);
    try {
      await deleteSession(name, signal);
    } catch (error) {
      this.events.notDeleted(name);
      throw error;
    }
  }
}

function contentOf({ scans, robots }: Session): string {
  return `${counted(scans, 'scan')}, ${counted(robots.length, 'robot')}`;
}
