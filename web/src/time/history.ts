/** The history of the open session: its scans in order, the selected scan, and playback. */
import { fetchHistory } from '../api/history';
import { isPassing } from '../api/http';
import type { Robot, Session } from '../api/types';
import type { PastPoses } from '../api/weaves';
import type { Trail } from '../live/trails';
import type { MapSource } from '../map/map_source';
import type { Picture } from '../picture';
import { poll, type Pace } from '../poll';
import type { Viewer } from '../viewer';
import { PastLoader, type PastSource } from './past_loader';
import { Player } from './player';
import { kGapMin, Timeline } from './timeline';
import { TimeTravel, type TravelEvents } from './time_travel';
import { ServerWeaver } from './weaver';
import * as words from './words';

/** Time between two requests for new scans. */
const kGrowthPace: Pace = { visibleMs: 1_000, hiddenMs: 10_000 };

export interface HistoryState {
  /** Empty until all scans up to the present are loaded. */
  timeline: Timeline;
  isKnown: boolean;
  /** Loaded part of the scans, 0 to 1. */
  share: number;
  /** The selected scan; null: the present. */
  index: number | null;
  /** The last scan of the shown map; null: the present. */
  shown: number | null;
  isPlaying: boolean;
  speed: number;
  /** The poses of past maps; null: no robot of the session has estimated poses. */
  poses: PastPoses | null;
  /** Log entries applied so far and in total, if the computation takes long. */
  progress: { applied: number; until: number } | null;
  /** The current error as a sentence; empty: none. */
  trouble: string;
}

const kAtFirst = { isKnown: false, share: 0, index: null, shown: null, isPlaying: false, progress: null, trouble: '' };

/** While the time bar is open. */
interface Visit {
  session: Session;
  state: HistoryState;
  player: Player;
  /** The scan at which playback starts when the map has loaded; null: it is playing or paused. */
  startAt: number | null;
  travel: TimeTravel;
  leave: AbortController;
}

export class SessionHistory {
  private visit: Visit | null = null;
  private frame = 0;
  private readonly listeners: ((state: HistoryState | null) => void)[] = [];

  constructor(
    private readonly viewer: Viewer,
    private readonly picture: Picture,
  ) {
    // Another session, or a recreated one, has another history.
    viewer.listen(() => this.close());
  }

  /** Calls the listener after every change; with null when the history is closed. */
  listen(listener: (state: HistoryState | null) => void): void {
    this.listeners.push(listener);
  }

  get isOpen(): boolean {
    return this.visit !== null;
  }

  /** Does nothing without a session. */
  open(): void {
    const { session } = this.viewer;
    if (this.visit || !session) return;
    const leave = new AbortController();
    const timeline = new Timeline();
    const player = new Player(timeline, () => performance.now() / 1000);
    const isEstimated = this.viewer.robots.some(({ localization }) => localization !== null);
    const poses = isEstimated ? 'then' : null;
    const state: HistoryState = { ...kAtFirst, timeline: new Timeline(), speed: player.speed, poses };
    const weaver = new ServerWeaver(
      session,
      session.cellSize,
      () => state.poses,
      () => this.picture.layersOfSession(),
      leave.signal,
    );
    const travel = new TimeTravel(weaver, this.travelEvents(), leave.signal, kTimer);
    this.visit = { session, state, player, startAt: null, travel, leave };
    this.notify();
    this.follow(this.visit, timeline);
  }

  /** Returns to the present and closes the history. */
  close(): void {
    if (!this.visit) return;
    this.goLive();
    this.visit.leave.abort();
    this.visit = null;
    this.notify();
  }

  /** Selects that scan; playback continues from there. */
  seek(index: number): void {
    if (!this.visit || this.visit.state.timeline.count === 0) return;
    const { player, state } = this.visit;
    const to = Math.min(state.timeline.count - 1, Math.max(0, index));
    if (player.isPlaying) this.playFrom(to);
    this.goTo(to);
  }

  /** Moves on by this many scans; ends playback. */
  step(scans: number): void {
    if (!this.visit) return;
    const { player, state } = this.visit;
    player.pause();
    const from = state.index ?? state.timeline.count - 1;
    if (state.index === null && scans > 0) return this.change({ isPlaying: false });
    this.seek(from + scans);
  }

  /** Playback starts at the first scan when the last scan or the present is selected. */
  togglePlaying(): void {
    if (!this.visit || this.visit.state.timeline.count === 0) return;
    const { player, state } = this.visit;
    if (player.isPlaying) {
      player.pause();
      return this.change({ isPlaying: false });
    }
    const isAtEnd = state.index === null || state.index >= state.timeline.count - 1;
    const from = isAtEnd ? 0 : (state.index ?? 0);
    this.playFrom(from);
    this.goTo(from);
    this.nextFrame();
  }

  private playFrom(index: number): void {
    if (!this.visit) return;
    this.visit.startAt = index;
    this.visit.player.play(index);
  }

  setSpeed(speed: number): void {
    this.visit?.player.setSpeed(speed);
    this.change({ speed });
  }

  /** Shows past maps, also the one that is shown now, with these poses. */
  setPoses(poses: PastPoses): void {
    if (!this.visit) return;
    this.change({ poses });
    this.visit.travel.invalidate();
    const { index } = this.visit.state;
    if (index !== null) this.goTo(index);
  }

  /** Shows the live map. */
  goLive(): void {
    if (!this.visit) return;
    this.visit.player.pause();
    this.visit.travel.stop();
    this.viewer.showMoment(null);
    this.change({ index: null, shown: null, isPlaying: false, progress: null, trouble: '' });
  }

  /** At most once per frame, and only while the page is visible. */
  private tick(): void {
    if (!this.visit?.player.isPlaying) return;
    const { player, state, startAt } = this.visit;
    if (startAt !== null) {
      player.play(startAt);
      if (state.shown === startAt) this.visit.startAt = null;
      return this.nextFrame();
    }
    const due = player.due();
    if (due !== null && due !== state.index) this.goTo(due);
    else if (!player.isPlaying) this.change({ isPlaying: false });
    this.nextFrame();
  }

  private nextFrame(): void {
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame(() => this.tick());
  }

  private goTo(index: number): void {
    if (!this.visit) return;
    const { travel, player, state } = this.visit;
    travel.go(state.timeline.revisionOf(index));
    this.change({ index, isPlaying: player.isPlaying });
  }

  private travelEvents(): TravelEvents {
    return {
      arrived: (revision, source) => this.show(revision, source),
      weaving: (applied, until) => this.change({ progress: { applied, until }, trouble: '' }),
      failed: (error, trying) => {
        if (!trying) this.visit?.player.pause();
        const isPlaying = this.visit?.player.isPlaying ?? false;
        this.change({ progress: null, isPlaying, trouble: words.troubleOf(error, trying) });
      },
      rested: () => this.change({ progress: null }),
    };
  }

  private show(revision: number, source: MapSource): void {
    if (!this.visit) return;
    const { timeline } = this.visit.state;
    const shown = timeline.indexAtRevision(revision);
    const there = timeline.whereabouts(shown);
    const bodies = new Map(this.viewer.robots.map(({ name, bodyRadius }) => [name, bodyRadius]));
    const robots = there.map(({ robot, pose, trail, age }): Robot => {
      const bodyRadius = bodies.get(robot) ?? null;
      return { name: robot, pose, bodyRadius, localization: null, scans: trail.length, connected: age <= kGapMin };
    });
    const trails = new Map(
      there.map(({ robot, trail, length }): [string, Trail] => [robot, { points: trail, length }]),
    );
    this.viewer.showMoment({ source, robots, trails });
    this.change({ shown, progress: null, trouble: '' });
  }

  /** Loads the scans, then new ones while the time bar is open. */
  private follow({ session, state, leave }: Visit, timeline: Timeline): void {
    const newest = (): number => this.viewer.session?.revision ?? 0;
    const source: PastSource = {
      fetchAfter: (revision, signal) => fetchHistory(session.name, revision, signal),
      loading: (share) => this.change({ share, trouble: '' }),
      // The scans appear only when complete: their oldest part would look like the whole.
      loaded: () => this.change(state.isKnown ? {} : { timeline, isKnown: true, trouble: '' }),
    };
    const loader = new PastLoader(timeline, newest, source);
    const load = (signal: AbortSignal): Promise<void> => loader.load(signal);
    const giveUp = new AbortController();
    void poll(load, kGrowthPace, AbortSignal.any([leave.signal, giveUp.signal]), (error) => {
      if (error === null) return;
      const trying = isPassing(error);
      if (!state.isKnown) this.change({ trouble: words.troubleOf(error, trying) });
      if (!trying) giveUp.abort(); // until the time bar opens again
    });
  }

  private change(change: Partial<HistoryState>): void {
    if (!this.visit) return;
    Object.assign(this.visit.state, change);
    this.notify();
  }

  private notify(): void {
    for (const listener of this.listeners) listener(this.visit?.state ?? null);
  }
}

const kTimer = {
  now: (): number => performance.now(),
  rest: (durationMs: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, durationMs)),
};
