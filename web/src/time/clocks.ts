/** Maps the time stamps of robots with different clocks to one increasing time line. */

/** A clock whose first stamp differs from another clock by less than this counts as the same clock. Seconds. */
const kSameClock = 3_600;
/** A robot's stamps that decrease by more than this come from a clock that was set back. Seconds. */
const kSetBack = 10;

interface Clock {
  /** Offset to add to the robot's stamps. */
  offset: number;
  last: number;
}

/** The time line follows the clock of the first robot. */
export class Clocks {
  private readonly byRobot = new Map<string, Clock>();
  private readonly offsets: number[] = [];
  private now = -Infinity;

  /** @returns the time of the robot's next scan on the line; scans have to be passed in order */
  place(robot: string, stamp: number): number {
    const clock = this.clockOf(robot, stamp);
    clock.last = stamp;
    this.now = Math.max(this.now, stamp + clock.offset);
    return this.now;
  }

  private clockOf(robot: string, stamp: number): Clock {
    const known = this.byRobot.get(robot);
    if (known && stamp >= known.last - kSetBack) return known;
    // A clock that was set back is behind the line: an accidental match with another clock would stop the line.
    const offset = known ? this.now - stamp : (this.offsetLike(stamp) ?? this.now - stamp);
    const clock = { offset, last: stamp };
    this.byRobot.set(robot, clock);
    if (!this.offsets.includes(offset)) this.offsets.push(offset);
    return clock;
  }

  /** Undefined: no known clock shows a similar time now. */
  private offsetLike(stamp: number): number | undefined {
    if (this.offsets.length === 0) return 0;
    return this.offsets.find((offset) => Math.abs(stamp + offset - this.now) <= kSameClock);
  }
}
