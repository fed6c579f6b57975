/** The robots of the chosen session; the view can follow one. */
import type { Robot } from '../api/types';
import { el, KeyedList, setText, type Row } from '../dom';
import * as format from '../format';
import { needsPlace, qualityOf, wordsOf } from './localization';
import type { RobotColours } from '../robot_colours';

export interface RobotListSource {
  pathLength(robot: string): number;
}

interface RobotRow extends Row {
  swatch: HTMLElement;
  detail: HTMLElement;
  place: HTMLElement;
  localization: HTMLElement;
  locate: HTMLButtonElement;
  follow: HTMLButtonElement;
}

export class RobotList {
  private readonly rows: KeyedList<Robot, RobotRow>;
  private robots: Robot[] = [];
  private colours: RobotColours | null = null;
  private followed: string | null = null;
  private isOffline = false;

  /** @param locate called to say where a robot is, with the button for it */
  constructor(
    list: HTMLElement,
    private readonly source: RobotListSource,
    private readonly follow: (robot: string | null) => void,
    private readonly locate: (robot: string, button: HTMLButtonElement) => void,
  ) {
    this.rows = new KeyedList(
      list,
      ({ name }) => name,
      (robot) => this.createRow(robot),
      (row, robot) => this.update(row, robot),
    );
  }

  show(robots: Robot[], colours: RobotColours): void {
    this.robots = robots;
    this.colours = colours;
    this.rows.show(robots);
  }

  /** Called when the trails have grown. */
  refresh(): void {
    this.rows.show(this.robots);
  }

  clear(): void {
    this.robots = [];
    this.rows.show([]);
  }

  setFollowed(robot: string | null): void {
    this.followed = robot;
    this.rows.show(this.robots);
  }

  /** @param isOffline whether the server does not answer: the state of the robots is unknown */
  setOffline(isOffline: boolean): void {
    this.isOffline = isOffline;
    this.rows.show(this.robots);
  }

  private createRow({ name }: Robot): RobotRow {
    const swatch = el('span', { class: 'swatch' });
    const detail = el('span', { class: 'row-detail' });
    const place = el('span', { class: 'row-detail numeric', 'data-role': 'pose' });
    const localization = el('span', { class: 'row-detail localization', 'data-role': 'localization' });
    const locate = el('button', { type: 'button', class: 'locate', 'aria-pressed': 'false' }, 'Locate');
    locate.setAttribute('aria-label', `Locate ${name}: say where it is`);
    locate.addEventListener('click', () => this.locate(name, locate));
    const follow = el('button', { type: 'button', class: 'follow', 'aria-label': `Follow ${name}` }, 'Follow');
    follow.addEventListener('click', () => this.follow(this.followed === name ? null : name));
    const title = el('span', { class: 'row-name', dir: 'auto' }, name);
    const element = el('li', { class: 'robot' }, swatch, title, follow, detail, place, localization, locate);
    return { element, swatch, detail, place, localization, locate, follow };
  }

  private update(row: RobotRow, robot: Robot): void {
    row.element.dataset['robot'] = robot.name;
    row.swatch.dataset['colour'] = String(this.colours?.indexOf(robot.name) ?? 0);
    row.swatch.classList.toggle('hollow', this.isOffline || !robot.connected);
    const travelled = format.length(this.source.pathLength(robot.name));
    const state = this.isOffline ? 'unknown' : robot.connected ? 'online' : 'offline';
    setText(row.detail, [state, format.counted(robot.scans, 'scan'), travelled].join(' \u00b7 '));
    setText(row.place, robot.pose ? format.pose(robot.pose) : 'no position yet');
    row.localization.hidden = row.locate.hidden = robot.localization === null;
    if (robot.localization) {
      row.localization.dataset['quality'] = qualityOf(robot.localization);
      setText(row.localization, wordsOf(robot.localization));
      row.locate.classList.toggle('primary', needsPlace(robot.localization));
    }
    row.follow.disabled = !robot.pose;
    row.follow.setAttribute('aria-pressed', String(robot.name === this.followed));
  }
}
