/** Puts the stamps of robots with unlike clocks on one line of time, which never goes back. */

/** A clock that is as near as this to another when it is first heard of is the same clock. Seconds. */
const kSameClock = 3_600;
/** Stamps of one robot that fall back further than this come from a clock that was set anew. Seconds. */
const kSetBack = 10;

interface Clock {
  /** To be added to its stamps. */
  offset: number;
  last: number;
}

/** The line is the clock of the robot that was heard of first. */
export class Clocks {
  private readonly byRobot = new Map<string, Clock>();
  private readonly offsets: number[] = [];
  private now = -Infinity;

  /** @returns when the robot's next scan is on the line; scans have to come in their order */
  place(robot: string, stamp: number): number {
    const clock = this.clockOf(robot, stamp);
    clock.last = stamp;
    this.now = Math.max(this.now, stamp + clock.offset);
    return this.now;
  }

  private clockOf(robot: string, stamp: number): Clock {
    const known = this.byRobot.get(robot);
    if (known && stamp >= known.last - kSetBack) return known;
    // Set back, it shows less than before: what it shares with others by chance would stop the line.
    const offset = known ? this.now - stamp : (this.offsetLike(stamp) ?? this.now - stamp);
    const clock = { offset, last: stamp };
    this.byRobot.set(robot, clock);
    if (!this.offsets.includes(offset)) this.offsets.push(offset);
    return clock;
  }

  /** Undefined: no clock that is known shows anything like this by now. */
  private offsetLike(stamp: number): number | undefined {
    if (this.offsets.length === 0) return 0;
    return this.offsets.find((offset) => Math.abs(stamp + offset - this.now) <= kSameClock);
  }
}
