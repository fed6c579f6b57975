import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import type { Session } from '../../../../web/src/api/types';
import { arrange, keepOrder, matches } from '../../../../web/src/sessions/order';

function session(name: string, created: string, number = 1): Session {
  return {
    name,
    id: name,
    created,
    number,
    revision: 0,
    exclusions: 0,
    scans: 0,
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

const kSessions = [session('lab-10', '2026-03-01'), session('lab-9', '2026-01-01'), session('Attic', '2026-02-01')];
const names = (sessions: Session[]): string[] => sessions.map(({ name }) => name);

describe('session search', () => {
  it('finds all words in any case and order', () => {
    assert.ok(matches('Intel-Lab_3', 'lab INTEL'));
    assert.ok(!matches('Intel-Lab_3', 'lab hall'));
  });

  it('finds all sessions for an empty text', () => {
    for (const query of ['', '  ']) assert.ok(matches('any', query));
  });

  it('treats the text as characters, not as a pattern', () => {
    assert.ok(!matches('abc', '.*'));
    assert.ok(matches('a.*c', '.*'));
  });
});

describe('session order', () => {
  it('by name is natural, with 9 before 10', () => {
    assert.deepEqual(names(arrange(kSessions, 'name', () => null)), ['Attic', 'lab-9', 'lab-10']);
  });

  it('by age starts with the newest', () => {
    assert.deepEqual(names(arrange(kSessions, 'newest', () => 5)), ['lab-10', 'Attic', 'lab-9']);
  });

  it('by age orders sessions of the same second by number', () => {
    const sessions = [session('a', '2026-03-01', 2), session('b', '2026-03-01', 10), session('c', '2026-03-01', 9)];
    assert.deepEqual(names(arrange(sessions, 'newest', () => null)), ['b', 'c', 'a']);
  });

  it('by rate starts with the highest rate, then the newest', () => {
    const rate = (name: string): number | null => (name === 'lab-9' ? 3 : name === 'Attic' ? 0 : null);
    assert.deepEqual(names(arrange(kSessions, 'busiest', rate)), ['lab-9', 'lab-10', 'Attic']);
  });

  it('does not change while the pointer is over it', () => {
    assert.deepEqual(names(keepOrder(kSessions, ['Attic', 'gone', 'lab-9'])), ['Attic', 'lab-9', 'lab-10']);
  });
});
