/** The scans of a session one after the other: when each was taken, and where the robots were by then. */
import type { TimedTrack } from '../api/history';
import type { Point, Pose } from '../api/types';
import { Clocks } from './clocks';
import { lastUpTo } from './search';

/** So long without a scan is a gap, seconds; it is played in the time below. */
export const kGapMin = 30;
const kGapPlayed = 2;
/** Stamps from here on count from 1970: those of a robot that has run for years are below. */
const kWallClockMin = 1e8;

/** A time without scans. */
export interface Gap {
  /** The scan that ends it. */
  index: number;
  /** Seconds. */
  duration: number;
}

/** Where a robot was, and how it had come there. */
export interface Whereabouts {
  robot: string;
  pose: Pose;
  trail: Point[];
  /** Metres travelled. */
  length: number;
  /** Seconds between its newest scan and the moment that was asked about. */
  age: number;
}

/** One robot's scans. */
interface Course {
  points: Point[];
  revisions: number[];
  yaws: number[];
  /** Metres travelled up to each. */
  lengths: number[];
}

export class Timeline {
  readonly gaps: Gap[] = [];
  private readonly revisions: number[] = [];
  /** Seconds on the line. */
  private readonly times: number[] = [];
  /** Seconds that playing takes up to each, at its own speed. */
  private readonly played: number[] = [];
  private readonly courses = new Map<string, Course>();
  private readonly clocks = new Clocks();

  /** How many scans there are; they are numbered from 0. */
  get count(): number {
    return this.revisions.length;
  }

  /** Whether times are seconds since 1970; otherwise those of a clock that began when it liked. */
  get isWallClock(): boolean {
    return (this.times[0] ?? 0) >= kWallClockMin;
  }

  /** What came since; scans that are known already are left aside. */
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

  /** Seconds from the beginning when it is played as fast as it was taken, gaps cut short. */
  playedOf(index: number): number {
    return this.played[index] ?? 0;
  }

  /** The last scan that is due by then. */
  indexAtPlayed(seconds: number): number {
    return Math.max(0, lastUpTo(this.played, seconds));
  }

  /** The last scan up to that time of the line; -1: there was none. */
  indexAtTime(time: number): number {
    return lastUpTo(this.times, time);
  }

  /** The last scan that is in that revision; -1: none is. */
  indexAtRevision(revision: number): number {
    return lastUpTo(this.revisions, revision);
  }

  /** Seconds without scans before this one; 0: there was no gap. */
  gapBefore(index: number): number {
    return this.gaps.find((gap) => gap.index === index)?.duration ?? 0;
  }

  /** Of all robots that had been heard of by that scan. */
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
