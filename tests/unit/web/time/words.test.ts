import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { Refused, Unreachable } from '../../../../web/src/api/http';
import { Timeline } from '../../../../web/src/time/timeline';
import { WeaveFailed } from '../../../../web/src/time/time_travel';
import * as words from '../../../../web/src/time/words';

function timelineFrom(start: number): Timeline {
  const line = new Timeline();
  const [revisions, stamps] = [
    [3, 4],
    [start, start + 95],
  ];
  line.add([
    {
      robot: 'a',
      points: [
        [0, 0],
        [1, 0],
      ],
      revisions,
      stamps,
      yaws: [0, 0],
    },
  ]);
  return line;
}

describe('time texts', () => {
  it('count from the start', () => {
    assert.equal(words.elapsed(0), '+00:00');
    assert.equal(words.elapsed(95.9), '+01:35');
    assert.equal(words.elapsed(3_695), '+1:01:35');
  });

  it('are short for long durations', () => {
    assert.deepEqual([45, 600, 3_600, 3_720, 90_000].map(words.duration), [
      '45 s',
      '10 min',
      '1 h',
      '1 h 2 min',
      '1 d 1 h',
    ]);
  });

  it('say which poses a past map has', () => {
    assert.match(words.pastOf('', null), /^Map, robots and trails as they were then; newest scans/);
    assert.match(
      words.pastOf('May 3', 'then'),
      /^Map as it was believed to be then, May 3; robots and trails at the poses/,
    );
    assert.match(
      words.pastOf('May 3', 'now'),
      /^Map, robots and trails of that time, May 3, at the poses known today;/,
    );
  });

  it('contain the time of day only for Unix time', () => {
    assert.equal(words.scanOf(timelineFrom(12), 1), 'scan 2 of 2, +01:35');
    assert.equal(words.dateOf(timelineFrom(12), 1), '');
    const noon = new Date(2026, 4, 3, 12, 1, 30).getTime() / 1000;
    assert.equal(words.scanOf(timelineFrom(noon), 1), 'scan 2 of 2, 12:03:05 (+01:35)');
    assert.match(words.dateOf(timelineFrom(noon), 1), /2026/);
  });

  it('contain the loaded share of the history if it is not zero', () => {
    assert.equal(words.loading(0), 'Loading the history\u2026');
    assert.equal(words.loading(0.337), 'Loading the history\u2026 33 %');
  });

  it('describe the error and the next step', () => {
    assert.match(words.troubleOf(new Unreachable('x'), true), /^Offline: .* Trying again\.$/);
    assert.match(words.troubleOf(new Refused(503, 'too many maps'), true), /reports: too many maps\. Trying again\.$/);
    assert.match(words.troubleOf(new Refused(404, 'x'), true), /computes it again/);
    assert.match(words.troubleOf(new WeaveFailed('no room.'), false), /could not be computed: no room\.$/);
  });
});
