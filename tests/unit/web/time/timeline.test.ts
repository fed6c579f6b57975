import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import type { TimedTrack } from '../../../../web/src/api/history';
import type { Point } from '../../../../web/src/api/types';
import { Timeline } from '../../../../web/src/time/timeline';

/** @param scans [revision, stamp] of each; the robot moves 1 m along x per scan */
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
  it('contains the scans of all robots in log order', () => {
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

  it('places a different clock at the current end of the timeline', () => {
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

  it('lets a third robot share the second robot\u2019s clock', () => {
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

  it('counts from the first scan if stamps are not Unix time', () => {
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

  it('never goes back, neither for jitter nor for a clock step', () => {
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

  it('finds scans by time, by revision and by playing time', () => {
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

  it('shortens pauses without scans when it plays and reports them', () => {
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

  it('returns robot poses and their trajectories', () => {
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
    assert.deepEqual(others, [], 'b has no scan before');
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

  it('adds new scans and ignores known ones', () => {
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
