/** Selects the open session: the one that the page's address names, or else the most active one. */
import { fetchRobotPort, fetchSessions } from './api/api';
import type { RobotPort, Session } from './api/types';
import { hashOfSession, sessionOfHash } from './address';
import { byId, setText } from './dom';
import type { NewestSessions } from './newest_sessions';
import type { Notice } from './panel/notice';
import { poll, type Pace } from './poll';
import { newestFirst } from './sessions/order';
import type { SessionPanel } from './sessions/session_panel';
import type { Viewer } from './viewer';

const kPace: Pace = { visibleMs: 2_000, hiddenMs: 15_000 };

export interface ChooserParts {
  viewer: Viewer;
  panel: SessionPanel;
  notice: Notice;
  newest: NewestSessions;
}

export class Chooser {
  private robotPort: RobotPort | null = null;
  private refreshing = false;
  private refreshedAt = -Infinity;

  constructor(private readonly parts: ChooserParts) {}

  /** Polls all sessions. @param settled called with the outcome of each poll */
  run(settled: (error: unknown) => void): void {
    void poll((signal) => this.refresh(signal), kPace, new AbortController().signal, settled);
  }

  /** Polls once between two rounds; the next round reports errors. */
  async refreshSoon(): Promise<void> {
    if (this.refreshing || performance.now() - this.refreshedAt < kPace.visibleMs) return;
    this.refreshing = true;
    this.refreshedAt = performance.now();
    await this.refresh(new AbortController().signal).catch(() => {});
    this.refreshing = false;
  }

  /** Follows the page's address. */
  open(): void {
    const name = sessionOfHash(location.hash);
    if (name === null) return;
    this.title(name);
    this.parts.panel.choose(name);
    this.parts.viewer.watch(name);
  }

  /** Called when the user has deleted a session: opens another one, or waits until there is one. */
  leave(name: string): void {
    if (sessionOfHash(location.hash) !== name) return;
    const { viewer, notice, panel } = this.parts;
    viewer.close();
    history.replaceState(null, '', location.pathname + location.search);
    this.title(null);
    notice.show({ kind: 'loading' });
    if (panel.all.length > 0) void this.chooseFrom(panel.all, new AbortController().signal);
  }

  private async refresh(signal: AbortSignal): Promise<void> {
    const { viewer, panel, notice, newest } = this.parts;
    const answer = await fetchSessions(signal);
    const learnt = answer.sessions.map((session) => newest.learn(session));
    const sessions = panel.show(learnt, answer.damaged);
    const chosen = sessionOfHash(location.hash);
    if (chosen === null) return this.chooseFrom(sessions, signal);
    for (const session of sessions) if (session.name === chosen) viewer.refresh(session);
    for (const { name, reason } of answer.damaged) if (name === chosen) notice.show({ kind: 'damaged', name, reason });
  }

  /** The most active session, or else the newest. */
  private async chooseFrom(sessions: Session[], signal: AbortSignal): Promise<void> {
    const ordered = [...sessions].sort(newestFirst);
    const live = ordered.find(({ robots }) => robots.some(({ connected }) => connected));
    const choice = live ?? ordered[0];
    if (!choice) {
      this.robotPort ??= await fetchRobotPort(signal);
      const { notice } = this.parts;
      return notice.show({ kind: 'no-sessions', robots: this.robotPort, pageHost: location.hostname });
    }
    history.replaceState(null, '', hashOfSession(choice.name));
    this.open();
  }

  private title(name: string | null): void {
    document.title = name === null ? 'Scanloom' : `${name} \u2013 Scanloom`;
    setText(byId('chosen', HTMLElement), name ?? '');
  }
}
