import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import type { TimedTrack } from '../../../../web/src/api/history';
import type { Point } from '../../../../web/src/api/types';
import { Timeline } from '../../../../web/src/time/timeline';

/** @param scans [revision, stamp] of each; the robot moves a metre along x every scan */
function track(robot: string, scans: [revision: number, stamp: number][]): TimedTrack {
  return {
    robot,
    points: scans.map((_, at): Point => [at, 0]),
    revisions: scans.map(([revision]) => revision),
    stamps: scans.map(([, stamp]) => stamp),
    yaws: scans.map((_, at) => at / 10),
  };
}

function timeline(...tracks: TimedTrack[]): Timeline {
  const line = new Timeline();
  line.add(tracks);
  return line;
}

function timesOf(line: Timeline): number[] {
  return Array.from({ length: line.count }, (_, index) => line.timeOf(index));
}

describe('a timeline', () => {
  it('has the scans of all robots in the order of the log', () => {
    const line = timeline(
      track('a', [
        [3, 100],
        [6, 103],
      ]),
      track('b', [
        [4, 101],
        [5, 102],
      ]),
    );
    assert.equal(line.count, 4);
    assert.deepEqual(
      [0, 1, 2, 3].map((index) => line.revisionOf(index)),
      [3, 4, 5, 6],
    );
    assert.deepEqual(timesOf(line), [100, 101, 102, 103]);
    assert.equal(line.sinceStart(3), 3);
  });

  it('puts a clock that is unlike the others where the line stands', () => {
    const line = timeline(
      track('a', [
        [1, 1_700_000_000],
        [3, 1_700_000_010],
      ]),
      track('b', [
        [2, 5],
        [4, 16],
      ]),
    );
    assert.deepEqual(
      timesOf(line),
      [0, 0, 10, 11].map((seconds) => 1_700_000_000 + seconds),
    );
    assert.ok(line.isWallClock);
  });

  it('has a third robot share the second one\u2019s clock', () => {
    const tracks = [
      track('a', [[1, 1_700_000_000]]),
      track('b', [
        [2, 5],
        [3, 25],
      ]),
      track('c', [[4, 28]]),
    ];
    assert.deepEqual(timesOf(timeline(...tracks)).at(-1), 1_700_000_023);
  });

  it('counts from the first scan where clocks tell no time of day', () => {
    const line = timeline(
      track('a', [
        [1, 33],
        [2, 34],
      ]),
      track('b', [[3, 1_700_000_000]]),
    );
    assert.ok(!line.isWallClock);
    assert.deepEqual(timesOf(line), [33, 34, 34]);
  });

  it('never goes back, be it for a jitter or for a clock that is set anew', () => {
    assert.deepEqual(
      timesOf(
        timeline(
          track('a', [
            [1, 10],
            [2, 9.5],
            [3, 11],
          ]),
        ),
      ),
      [10, 10, 11],
    );
    assert.deepEqual(
      timesOf(
        timeline(
          track('a', [
            [1, 500],
            [2, 510],
            [3, 0],
            [4, 7],
          ]),
        ),
      ),
      [500, 510, 510, 517],
    );
  });

  it('finds scans by time, by revision and by how long it plays', () => {
    const line = timeline(
      track('a', [
        [3, 100],
        [5, 102],
        [9, 104],
      ]),
    );
    assert.deepEqual(
      [99, 100, 103, 999].map((time) => line.indexAtTime(time)),
      [-1, 0, 1, 2],
    );
    assert.deepEqual(
      [2, 3, 8, 99].map((revision) => line.indexAtRevision(revision)),
      [-1, 0, 1, 2],
    );
    assert.deepEqual(
      [-1, 0, 1.9, 2, 99].map((played) => line.indexAtPlayed(played)),
      [0, 0, 0, 1, 2],
    );
  });

  it('cuts times without scans short when it is played, and tells them', () => {
    const line = timeline(
      track('a', [
        [1, 0],
        [2, 5],
        [3, 3_605],
        [4, 3_606],
      ]),
    );
    assert.deepEqual(line.gaps, [{ index: 2, duration: 3_600 }]);
    assert.equal(line.gapBefore(2), 3_600);
    assert.equal(line.gapBefore(1), 0);
    assert.deepEqual(
      [0, 1, 2, 3].map((index) => line.playedOf(index)),
      [0, 5, 7, 8],
    );
    assert.equal(line.sinceStart(3), 3_606);
  });

  it('knows where robots were, and how they had come there', () => {
    const line = timeline(
      track('a', [
        [1, 0],
        [2, 1],
        [5, 4],
      ]),
      track('b', [
        [3, 2],
        [4, 3],
      ]),
    );
    const [a, ...others] = line.whereabouts(1);
    assert.deepEqual(others, [], 'b had not begun');
    assert.deepEqual(a, {
      robot: 'a',
      pose: { x: 1, y: 0, yaw: 0.1 },
      trail: [
        [0, 0],
        [1, 0],
      ],
      length: 1,
      age: 0,
    });
    const later = line.whereabouts(3);
    assert.deepEqual(
      later.map(({ robot, trail, age }) => [robot, trail.length, age]),
      [
        ['a', 2, 2],
        ['b', 2, 0],
      ],
    );
  });

  it('grows by what came since, and leaves aside what it knows', () => {
    const line = timeline(
      track('a', [
        [1, 0],
        [2, 1],
      ]),
    );
    line.add([
      track('a', [
        [2, 1],
        [3, 2],
      ]),
      track('b', [[4, 3]]),
    ]);
    assert.deepEqual(timesOf(line), [0, 1, 2, 3]);
    assert.equal(line.whereabouts(3).find(({ robot }) => robot === 'a')?.trail.length, 3);
  });

  it('may be empty', () => {
    const line = new Timeline();
    line.add([]);
    assert.equal(line.count, 0);
    assert.deepEqual(line.whereabouts(0), []);
    assert.equal(line.indexAtPlayed(5), 0);
    assert.ok(!line.isWallClock);
  });
});
