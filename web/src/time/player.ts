/** Plays scans back: computes which scan is due, by a clock from the caller. */
import type { Timeline } from './timeline';

export const kSpeeds = [1, 2, 5, 10, 20, 50, 100] as const;

/** Scan and time at which playback started. */
interface Start {
  played: number;
  clock: number;
}

export class Player {
  private start: Start | null = null;
  private times = 10;

  /** @param clock seconds, of any monotonic clock */
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

  /** Changes the speed; playback continues at the current scan. */
  setSpeed(speed: number): void {
    const { start } = this;
    if (start) this.start = { played: this.playedBy(start), clock: this.clock() };
    this.times = speed;
  }

  /** Starts at this scan; while playing, jumps there. */
  play(from: number): void {
    this.start = { played: this.timeline.playedOf(from), clock: this.clock() };
  }

  pause(): void {
    this.start = null;
  }

  /**
   * Returns the newest scan that is due. A late call skips scans, so playback does not lag. Pauses at the last scan.
   *
   * @returns null: not playing
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
