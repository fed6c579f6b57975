/** The session's history below the map: a slider over its scans, and buttons for playback. */
import type { PastPoses } from '../api/weaves';
import { el, setText } from '../dom';
import * as format from '../format';
import type { Keys } from '../keys';
import type { HistoryState, SessionHistory } from '../time/history';
import { kSpeeds } from '../time/player';
import type { Timeline } from '../time/timeline';
import * as words from '../time/words';
import { iconButton, setIcon } from './icon_button';

const kIcons = {
  back: 'M11.5 4 6.5 8l5 4zM4.5 4v8',
  play: 'M5 3.5 12 8l-7 4.5z',
  pause: 'M5.5 4v8M10.5 4v8',
  forward: 'M4.5 4l5 4-5 4zM11.5 4v8',
  close: 'm4 4 8 8M12 4l-8 8',
};
const kPoses: [poses: PastPoses, label: string][] = [
  ['then', 'poses as believed then'],
  ['now', 'poses as known today'],
];
/** Maximum number of marks. */
const kMarksMax = 40;

export class TimeBar {
  private readonly back = iconButton('time-back', 'One scan back', ',', kIcons.back);
  private readonly play = iconButton('time-play', 'Play', 'Space', kIcons.play);
  private readonly forward = iconButton('time-forward', 'One scan forward', '.', kIcons.forward);
  private readonly slider = el('input', { id: 'time-slider', type: 'range', min: '1', max: '1', step: '1' });
  private readonly marks = el('div', { class: 'time-marks', 'aria-hidden': 'true' });
  private readonly speed = el('select', { id: 'time-speed', 'aria-label': 'Speed' });
  private readonly poses = el('select', { id: 'time-poses', 'aria-label': 'Poses of past maps' });
  private readonly live = el('button', { id: 'time-live', type: 'button', title: 'Back to the present (l)' }, 'Live');
  private readonly close = iconButton('time-close', 'Close the history', 't', kIcons.close);
  private readonly place = el('span', { id: 'time-place', class: 'numeric' });
  private readonly mode = el('strong', { id: 'time-mode', class: 'time-mode', role: 'status' });
  private readonly note = el('span', { id: 'time-note', class: 'quiet' });
  private readonly message = el('span', { id: 'time-message', class: 'time-message', role: 'status' });
  private readonly progress = el('progress', { 'aria-label': 'Weaving' });
  private marked = '';
  private isOffline = false;
  private state: HistoryState | null = null;

  /** @param opener the button that opens the bar */
  constructor(
    private readonly bar: HTMLElement,
    private readonly opener: HTMLButtonElement,
    private readonly history: SessionHistory,
    keys: Keys,
  ) {
    this.slider.setAttribute('aria-label', 'Scan of the session');
    this.speed.append(...kSpeeds.map((speed) => el('option', { value: String(speed) }, `${speed}\u00d7`)));
    const track = el('div', { class: 'time-track' }, this.slider, this.marks);
    const steps = el('div', { class: 'time-steps' }, this.back, this.play, this.forward);
    this.poses.append(...kPoses.map(([poses, label]) => el('option', { value: poses }, label)));
    const ends = el('div', { class: 'time-ends' }, this.speed, this.live, this.close);
    const place = [this.mode, this.place, this.poses];
    const words = el('p', { class: 'time-words' }, ...place, this.note, this.progress, this.message);
    bar.append(steps, track, ends, words);
    this.connect();
    this.bindKeys(keys);
    history.listen((state) => this.show(state));
    this.show(null);
  }

  /** @param isOffline whether the server does not answer: then the mode is not "Live" */
  setOffline(isOffline: boolean): void {
    this.isOffline = isOffline;
    this.show(this.state);
  }

  private connect(): void {
    const { history } = this;
    this.opener.addEventListener('click', () => this.toggle());
    this.close.addEventListener('click', () => this.toggle());
    this.back.addEventListener('click', () => history.step(-1));
    this.forward.addEventListener('click', () => history.step(1));
    this.play.addEventListener('click', () => history.togglePlaying());
    this.live.addEventListener('click', () => history.goLive());
    this.slider.addEventListener('input', () => history.seek(this.slider.valueAsNumber - 1));
    this.speed.addEventListener('change', () => history.setSpeed(Number(this.speed.value)));
    this.poses.addEventListener('change', () => history.setPoses(this.poses.value === 'now' ? 'now' : 'then'));
  }

  private bindKeys(keys: Keys): void {
    const { history } = this;
    const when = (): boolean => history.isOpen;
    keys.bind({ key: 't', does: 'opens and closes the history', run: () => this.toggle() });
    keys.bind({ key: ' ', does: 'plays or pauses the history', run: () => history.togglePlaying(), when });
    keys.bind({ key: ',', does: 'moves one scan back in the history', run: () => history.step(-1), when });
    keys.bind({ key: '.', does: 'moves one scan forward in the history', run: () => history.step(1), when });
    keys.bind({ key: 'l', does: 'returns to the present', run: () => history.goLive(), when });
  }

  private toggle(): void {
    if (this.history.isOpen) {
      if (this.bar.contains(document.activeElement)) this.opener.focus();
      this.history.close();
    } else {
      this.history.open();
      this.slider.focus({ focusVisible: false } as FocusOptions);
    }
  }

  private show(state: HistoryState | null): void {
    this.state = state;
    this.bar.hidden = state === null;
    this.bar.dataset['time'] = state !== null && state.shown !== null ? 'past' : 'present';
    this.opener.setAttribute('aria-expanded', String(state !== null));
    if (!state) return;
    this.showSlider(state);
    this.showButtons(state);
    this.showWords(state);
    this.showMarks(state.timeline);
  }

  private showSlider({ timeline, index }: HistoryState): void {
    const { slider } = this;
    const last = Math.max(1, timeline.count);
    const now = index ?? timeline.count - 1;
    slider.max = String(last);
    slider.value = String(Math.max(1, now + 1));
    slider.setAttribute('aria-valuetext', timeline.count > 0 ? words.scanOf(timeline, now) : 'no scans');
  }

  private showButtons({ timeline, index, isPlaying, speed, poses }: HistoryState): void {
    const isEmpty = timeline.count === 0;
    for (const button of [this.back, this.play, this.forward]) button.disabled = isEmpty;
    setIcon(this.play, isPlaying ? 'Pause' : 'Play', 'Space', isPlaying ? kIcons.pause : kIcons.play);
    this.speed.value = String(speed);
    this.poses.hidden = poses === null;
    this.poses.value = poses ?? 'then';
    this.live.setAttribute('aria-pressed', String(index === null && !this.isOffline));
  }

  private showWords(state: HistoryState): void {
    const { timeline, isKnown, share, index, shown, progress, trouble, poses } = state;
    const { count } = timeline;
    setText(this.mode, shown !== null ? 'Past' : index !== null ? 'Going back' : this.isOffline ? 'Offline' : 'Live');
    const at = index ?? count - 1;
    setText(this.place, count > 0 ? `${words.scanOf(timeline, at)}${this.gapBefore(timeline, at)}` : '');
    const date = count > 0 ? words.dateOf(timeline, at) : '';
    this.place.title = date;
    setText(
      this.note,
      isKnown && count === 0
        ? 'No scans yet.'
        : shown === null && index !== null
          ? ''
          : shown !== null
            ? words.pastOf(date, poses)
            : this.presentNote(),
    );
    setText(this.message, trouble || (progress ? 'Computing that map\u2026' : isKnown ? '' : words.loading(share)));
    this.message.classList.toggle('trouble', trouble !== '');
    this.progress.hidden = progress === null;
    if (progress) Object.assign(this.progress, { max: Math.max(1, progress.until), value: progress.applied });
  }

  private presentNote(): string {
    return this.isOffline ? 'The map as it was last received.' : 'The map as it is now.';
  }

  private gapBefore(timeline: Timeline, index: number): string {
    const gap = timeline.gapBefore(index);
    return gap > 0 ? `, after ${words.duration(gap)} without scans` : '';
  }

  /** Marks the longest gaps on the slider. */
  private showMarks({ gaps, count }: Timeline): void {
    const fingerprint = `${gaps.length}/${count}`;
    if (this.marked === fingerprint) return;
    this.marked = fingerprint;
    const longest = [...gaps].sort((a, b) => b.duration - a.duration).slice(0, kMarksMax);
    this.marks.replaceChildren(
      ...longest.map(({ index }) => {
        const mark = el('span');
        mark.style.left = `${(100 * (index - 0.5)) / Math.max(1, count - 1)}%`;
        return mark;
      }),
    );
    const found = `${format.counted(gaps.length, 'gap')} without scans, marked here and played in a moment`;
    this.slider.title = gaps.length > 0 ? found : '';
  }
}
