import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import type { Session } from '../../../web/src/api/types';
import { NewestSessions } from '../../../web/src/newest_sessions';

function session(id: string, revision: number): Session {
  return {
    name: 'a',
    id,
    created: '',
    number: 1,
    revision,
    exclusions: 0,
    scans: revision,
    movingScans: 0,
    isLocalizeOnly: false,
    cellSize: 0.05,
    config: {},
    bounds: null,
    mainBounds: null,
    robots: [],
    failure: null,
  };
}

describe('the newest sessions', () => {
  it('ignore an outdated answer', () => {
    const newest = new NewestSessions();
    newest.learn(session('1', 9));
    assert.equal(newest.learn(session('1', 7)).scans, 9);
    assert.equal(newest.learn(session('1', 10)).scans, 10);
  });

  it('accept a lower revision of a recreated session', () => {
    const newest = new NewestSessions();
    newest.learn(session('1', 9));
    assert.equal(newest.learn(session('2', 1)).scans, 1);
  });

  it('accept an equal revision, because robots connect without scans', () => {
    const newest = new NewestSessions();
    newest.learn(session('1', 9));
    const later = session('1', 9);
    assert.equal(newest.learn(later), later);
  });
});
