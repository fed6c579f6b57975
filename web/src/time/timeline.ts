/** The scans of a session in order: when each was taken, and the robots' poses at that time. */
import type { TimedTrack } from '../api/history';
import type { Point, Pose } from '../api/types';
import { Clocks } from './clocks';
import { lastUpTo } from './search';

/** A longer time without a scan is a gap, seconds; playback shortens it to the time below. */
export const kGapMin = 30;
const kGapPlayed = 2;
/** Stamps from here count from 1970; the uptime of a robot that has run for years is less. */
const kWallClockMin = 1e8;

/** A time without scans. */
export interface Gap {
  /** The scan after the gap. */
  index: number;
  /** Seconds. */
  duration: number;
}

/** A robot's pose, and its trajectory up to there. */
export interface Whereabouts {
  robot: string;
  pose: Pose;
  trail: Point[];
  /** Metres travelled. */
  length: number;
  /** Seconds between its newest scan and the requested moment. */
  age: number;
}

/** One robot's scans. */
interface Course {
  points: Point[];
  revisions: number[];
  yaws: number[];
  /** Metres travelled up to each scan. */
  lengths: number[];
}

export class Timeline {
  readonly gaps: Gap[] = [];
  private readonly revisions: number[] = [];
  /** Seconds on the time line. */
  private readonly times: number[] = [];
  /** Playback time of each scan in seconds, at normal speed. */
  private readonly played: number[] = [];
  private readonly courses = new Map<string, Course>();
  private readonly clocks = new Clocks();

  /** The number of scans; they are numbered from 0. */
  get count(): number {
    return this.revisions.length;
  }

  /** Whether times are seconds since 1970; otherwise they are those of a clock with any origin. */
  get isWallClock(): boolean {
    return (this.times[0] ?? 0) >= kWallClockMin;
  }

  /** Appends scans; ignores those that are known. */
  add(tracks: TimedTrack[]): void {
    const newest = this.revisions.at(-1) ?? -1;
    const scans = tracks.flatMap((track) => track.revisions.map((revision, at) => ({ revision, track, at })));
    const added = scans.filter(({ revision }) => revision > newest).sort((a, b) => a.revision - b.revision);
    for (const { revision, track, at } of added) this.append(revision, track, at);
  }

  revisionOf(index: number): number {
    return this.revisions[index] ?? 0;
  }

  timeOf(index: number): number {
    return this.times[index] ?? 0;
  }

  /** Seconds since the first scan. */
  sinceStart(index: number): number {
    return this.timeOf(index) - this.timeOf(0);
  }

  /** Playback time in seconds at normal speed, with gaps shortened. */
  playedOf(index: number): number {
    return this.played[index] ?? 0;
  }

  /** The last scan that is due at that playback time. */
  indexAtPlayed(seconds: number): number {
    return Math.max(0, lastUpTo(this.played, seconds));
  }

  /** The last scan up to that time of the line; -1: there was none. */
  indexAtTime(time: number): number {
    return lastUpTo(this.times, time);
  }

  /** The last scan of that revision; -1: none. */
  indexAtRevision(revision: number): number {
    return lastUpTo(this.revisions, revision);
  }

  /** Seconds without scans before this one; 0: there was no gap. */
  gapBefore(index: number): number {
    return this.gaps.find((gap) => gap.index === index)?.duration ?? 0;
  }

  /** Poses of all robots that had taken a scan by then. */
  whereabouts(index: number): Whereabouts[] {
    const revision = this.revisionOf(index);
    const now = this.timeOf(index);
    return [...this.courses].flatMap(([robot, { points, revisions, yaws, lengths }]) => {
      const at = lastUpTo(revisions, revision);
      const [point, yaw] = [points[at], yaws[at]];
      if (!point || yaw === undefined) return [];
      const pose = { x: point[0], y: point[1], yaw };
      const age = now - this.timeOf(this.indexAtRevision(revisions[at] ?? 0));
      return [{ robot, pose, trail: points.slice(0, at + 1), length: lengths[at] ?? 0, age }];
    });
  }

  private append(revision: number, track: TimedTrack, at: number): void {
    const time = this.clocks.place(track.robot, track.stamps[at] ?? 0);
    const before = this.times.at(-1) ?? time;
    const passed = time - before;
    if (passed > kGapMin) this.gaps.push({ index: this.count, duration: passed });
    this.played.push((this.played.at(-1) ?? 0) + (passed > kGapMin ? kGapPlayed : passed));
    this.revisions.push(revision);
    this.times.push(time);
    this.follow(revision, track, at);
  }

  private follow(revision: number, { robot, points, yaws }: TimedTrack, at: number): void {
    const course = this.courses.get(robot) ?? { points: [], revisions: [], yaws: [], lengths: [] };
    this.courses.set(robot, course);
    const point = points[at] ?? [0, 0];
    const last = course.points.at(-1) ?? point;
    course.lengths.push((course.lengths.at(-1) ?? 0) + Math.hypot(point[0] - last[0], point[1] - last[1]));
    course.points.push(point);
    course.revisions.push(revision);
    course.yaws.push(yaws[at] ?? 0);
  }
}
