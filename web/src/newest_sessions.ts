/** The newest state of each session, whichever request returned it, so that all parts of the page show the same. */
import type { Session } from './api/types';

export class NewestSessions {
  private readonly byName = new Map<string, Session>();

  /** @returns this session, or the stored state when that is newer */
  learn(session: Session): Session {
    const known = this.byName.get(session.name);
    if (known && known.id === session.id && known.revision > session.revision) return known;
    this.byName.set(session.name, session);
    return session;
  }
}
