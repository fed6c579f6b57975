/** The past of the session that is open: its scans in order, which of them is looked at, and whether it is played. */
import { fetchHistory } from '../api/history';
import { isPassing } from '../api/http';
import type { Robot, Session } from '../api/types';
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

/** How often is looked for scans that came since. */
const kGrowthPace: Pace = { visibleMs: 1_000, hiddenMs: 10_000 };

export interface HistoryState {
  /** Empty until it is known up to the present. */
  timeline: Timeline;
  isKnown: boolean;
  /** How much of it has come by then, 0 to 1. */
  share: number;
  /** The scan that is asked for; null: the present. */
  index: number | null;
  /** The scan that the map ends with; null: it is that of the present. */
  shown: number | null;
  isPlaying: boolean;
  speed: number;
  /** Entries of the log that are woven, of how many, when it takes long. */
  progress: { woven: number; until: number } | null;
  /** What goes wrong, in a sentence; empty: nothing. */
  trouble: string;
}

const kAtFirst = { isKnown: false, share: 0, index: null, shown: null, isPlaying: false, progress: null, trouble: '' };

/** While somebody looks at the history. */
interface Visit {
  session: Session;
  state: HistoryState;
  player: Player;
  /** The scan from where playing begins, as soon as the map is there; null: it is under way. */
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
    // Another session, or the same made anew, has another past.
    viewer.listen(() => this.close());
  }

  /** Called whenever something is otherwise; null: it is closed. */
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
    const state: HistoryState = { ...kAtFirst, timeline: new Timeline(), speed: player.speed };
    const weaver = new ServerWeaver(session, session.cellSize, () => this.picture.layersOfSession(), leave.signal);
    const travel = new TimeTravel(weaver, this.travelEvents(), leave.signal, kTimer);
    this.visit = { session, state, player, startAt: null, travel, leave };
    this.tell();
    this.follow(this.visit, timeline);
  }

  /** Back to the present, and out of sight. */
  close(): void {
    if (!this.visit) return;
    this.goLive();
    this.visit.leave.abort();
    this.visit = null;
    this.tell();
  }

  /** To that scan, from where playing goes on if it plays. */
  seek(index: number): void {
    if (!this.visit || this.visit.state.timeline.count === 0) return;
    const { player, state } = this.visit;
    const to = Math.min(state.timeline.count - 1, Math.max(0, index));
    if (player.isPlaying) this.playFrom(to);
    this.goTo(to);
  }

  /** So many scans further on; playing ends. */
  step(scans: number): void {
    if (!this.visit) return;
    const { player, state } = this.visit;
    player.pause();
    const from = state.index ?? state.timeline.count - 1;
    if (state.index === null && scans > 0) return this.change({ isPlaying: false });
    this.seek(from + scans);
  }

  /** From the end or from the present it begins at the beginning. */
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

  /** The map as it is now. */
  goLive(): void {
    if (!this.visit) return;
    this.visit.player.pause();
    this.visit.travel.stop();
    this.viewer.showMoment(null);
    this.change({ index: null, shown: null, isPlaying: false, progress: null, trouble: '' });
  }

  /** At most once a frame, and only while anybody can see it. */
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
      weaving: (woven, until) => this.change({ progress: { woven, until }, trouble: '' }),
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
      return { name: robot, pose, bodyRadius, scans: trail.length, connected: age <= kGapMin };
    });
    const trails = new Map(
      there.map(({ robot, trail, length }): [string, Trail] => [robot, { points: trail, length }]),
    );
    this.viewer.showMoment({ source, robots, trails });
    this.change({ shown, progress: null, trouble: '' });
  }

  /** Fetches the scans, and those that come while somebody looks. */
  private follow({ session, state, leave }: Visit, timeline: Timeline): void {
    const newest = (): number => this.viewer.session?.revision ?? 0;
    const source: PastSource = {
      fetchAfter: (revision, signal) => fetchHistory(session.name, revision, signal),
      loading: (share) => this.change({ share, trouble: '' }),
      // Shown only now: its oldest part would be taken for the whole.
      loaded: () => this.change(state.isKnown ? {} : { timeline, isKnown: true, trouble: '' }),
    };
    const loader = new PastLoader(timeline, newest, source);
    const load = (signal: AbortSignal): Promise<void> => loader.load(signal);
    const giveUp = new AbortController();
    void poll(load, kGrowthPace, AbortSignal.any([leave.signal, giveUp.signal]), (error) => {
      if (error === null) return;
      const trying = isPassing(error);
      if (!state.isKnown) this.change({ trouble: words.troubleOf(error, trying) });
      if (!trying) giveUp.abort(); // until somebody looks again
    });
  }

  private change(change: Partial<HistoryState>): void {
    if (!this.visit) return;
    Object.assign(this.visit.state, change);
    this.tell();
  }

  private tell(): void {
    for (const listener of this.listeners) listener(this.visit?.state ?? null);
  }
}

const kTimer = {
  now: (): number => performance.now(),
  rest: (durationMs: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, durationMs)),
};
