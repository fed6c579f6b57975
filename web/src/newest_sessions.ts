/** The newest that was heard of each session, whichever question it answered: all parts of the page tell the same. */
import type { Session } from './api/types';

export class NewestSessions {
  private readonly byName = new Map<string, Session>();

  /** @returns this, or what is known already when that is newer */
  learn(session: Session): Session {
    const known = this.byName.get(session.name);
    if (known && known.id === session.id && known.revision > session.revision) return known;
    this.byName.set(session.name, session);
    return session;
  }
}
