import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { Player } from '../../../../web/src/time/player';
import { lastUpTo } from '../../../../web/src/time/search';

/** A player of one scan per second, with a clock that the test sets. */
function setUp(count = 100): { player: Player; clock: { now: number }; scans: { count: number } } {
  const clock = { now: 1_000 };
  const scans = { count };
  const played = (): number[] => Array.from({ length: scans.count }, (_, index) => index);
  const timeline = {
    get count() {
      return scans.count;
    },
    playedOf: (index: number) => index,
    indexAtPlayed: (seconds: number) => lastUpTo(played(), seconds),
  };
  return { player: new Player(timeline, () => clock.now), clock, scans };
}

describe('a player', () => {
  it('has no scan due before it plays', () => {
    const { player } = setUp();
    assert.equal(player.due(), null);
    assert.ok(!player.isPlaying);
  });

  it('plays from the given scan at the given speed', () => {
    for (const speed of [1, 10, 50]) {
      const { player, clock } = setUp();
      player.setSpeed(speed);
      player.play(7);
      assert.equal(player.due(), 7);
      clock.now += 1;
      assert.equal(player.due(), 7 + speed);
    }
  });

  it('skips scans between requests and never lags', () => {
    const { player, clock } = setUp();
    player.setSpeed(2);
    player.play(0);
    clock.now += 30;
    assert.equal(player.due(), 60);
  });

  it('continues from its position when the speed changes', () => {
    const { player, clock } = setUp();
    player.setSpeed(1);
    player.play(0);
    clock.now += 10;
    player.setSpeed(5);
    assert.equal(player.due(), 10);
    clock.now += 2;
    assert.equal(player.due(), 20);
  });

  it('pauses at the last scan', () => {
    const { player, clock } = setUp();
    player.setSpeed(100);
    player.play(0);
    clock.now += 60;
    assert.equal(player.due(), 99);
    assert.ok(!player.isPlaying);
    assert.equal(player.due(), null);
  });

  it('continues to scans that arrive while it plays', () => {
    const { player, clock, scans } = setUp(10);
    player.setSpeed(1);
    player.play(0);
    clock.now += 8;
    scans.count = 20;
    clock.now += 4;
    assert.equal(player.due(), 12);
    assert.ok(player.isPlaying);
  });
});
