/** Plays scans back: tells which is due, by a clock that is not its own. */
import type { Timeline } from './timeline';

export const kSpeeds = [1, 2, 5, 10, 20, 50, 100] as const;

/** Where and when it was started. */
interface Start {
  played: number;
  clock: number;
}

export class Player {
  private start: Start | null = null;
  private times = 10;

  /** @param clock seconds, from whenever it likes */
  constructor(
    private readonly timeline: Pick<Timeline, 'count' | 'playedOf' | 'indexAtPlayed'>,
    private readonly clock: () => number,
  ) {}

  get isPlaying(): boolean {
    return this.start !== null;
  }

  get speed(): number {
    return this.times;
  }

  /** While it plays, it goes on from where it is. */
  setSpeed(speed: number): void {
    const { start } = this;
    if (start) this.start = { played: this.playedBy(start), clock: this.clock() };
    this.times = speed;
  }

  /** From this scan on; also jumps there while it plays. */
  play(from: number): void {
    this.start = { played: this.timeline.playedOf(from), clock: this.clock() };
  }

  pause(): void {
    this.start = null;
  }

  /**
   * The newest scan that is due: whoever asks late skips those between, and is never behind.
   * With the last one it pauses.
   *
   * @returns null: it does not play
   */
  due(): number | null {
    if (!this.start) return null;
    const index = this.timeline.indexAtPlayed(this.playedBy(this.start));
    if (index >= this.timeline.count - 1) this.pause();
    return index;
  }

  private playedBy({ played, clock }: Start): number {
    return played + (this.clock() - clock) * this.times;
  }
}
