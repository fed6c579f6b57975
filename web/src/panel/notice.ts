/** The message that replaces the map when there is none to show. */
import type { RobotPort } from '../api/types';
import { el } from '../dom';

export type NoticeState =
  | { kind: 'none' }
  | { kind: 'loading' }
  | { kind: 'no-sessions'; robots: RobotPort; pageHost: string }
  | { kind: 'missing'; name: string }
  | { kind: 'deleted'; name: string }
  | { kind: 'damaged'; name: string; reason: string }
  | { kind: 'empty'; name: string };

export class Notice {
  private shown = '';

  constructor(private readonly card: HTMLElement) {}

  show(state: NoticeState): void {
    const fingerprint = JSON.stringify(state);
    if (fingerprint === this.shown) return;
    this.shown = fingerprint;
    this.card.hidden = state.kind === 'none';
    this.card.dataset['state'] = state.kind;
    this.card.replaceChildren(...contentOf(state));
  }
}

function contentOf(state: NoticeState): Node[] {
  switch (state.kind) {
    case 'none':
      return [];
    case 'loading':
      return [el('p', {}, 'Loading\u2026')];
    case 'no-sessions':
      return [
        el('h2', {}, 'No sessions yet'),
        el('p', {}, 'A session starts when a robot connects. Start a simulated robot:'),
        el(
          'pre',
          { tabindex: '0', 'aria-label': 'Command' },
          el('code', {}, robotCommand(state.robots, state.pageHost)),
        ),
        el('p', {}, 'The session appears here automatically.'),
      ];
    case 'missing':
      return [
        el('h2', {}, 'No such session'),
        el(
          'p',
          {},
          'There is no session ',
          named(state.name),
          '. Choose another one, or wait until a robot creates it.',
        ),
      ];
    case 'deleted':
      return [
        el('h2', {}, 'Session deleted'),
        el('p', {}, 'The session ', named(state.name), ' was deleted on the server. Choose another one.'),
      ];
    case 'damaged':
      return [
        el('h2', {}, 'Session not served'),
        el('p', {}, 'The server cannot show the session ', named(state.name), ': ', state.reason, '.'),
        el('p', {}, 'The other sessions are not affected.'),
      ];
    case 'empty':
      return [
        el('h2', {}, 'No scans yet'),
        el('p', {}, 'The session ', named(state.name), ' is open and waits for the first scan.'),
      ];
  }
}

function named(name: string): HTMLElement {
  return el('strong', { dir: 'auto' }, name);
}

/** @param pageHost host of this page: a server that listens on every address accepts robots there, too */
function robotCommand({ host, port }: RobotPort, pageHost: string): string {
  const address = host?.includes(':') ? `[${host}]` : (host ?? pageHost);
  return [
    `build/bin/scanloom-robot --server ${address}:${port} \\`,
    '    --session demo --robot r1 \\',
    '    simulate --world office --drive wall_follower --seed 1',
  ].join('\n');
}
