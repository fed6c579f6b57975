/** The session's mapping settings, to be changed for a weave. Marks those that differ from the session's. */
import type { MapConfig } from '../../api/types';
import type { WeaveRequest } from '../../api/weaves';
import { el, setText } from '../../dom';
import { checkbox, labelled, numberInput, selectOf } from '../fields';
import { kRayModels } from '../ray_models';

interface Setting {
  name: string;
  label: string;
  kind: 'number' | 'switch' | 'rays';
  min?: number;
  max?: number;
  /** Ray models that the setting affects; all if absent. */
  rays?: string[];
}

const kSettings: Setting[] = [
  { name: 'cell_size', label: 'Cell, m', kind: 'number', min: 0.01, max: 1 },
  { name: 'ray_model', label: 'Laser scans', kind: 'rays' },
  { name: 'accumulate', label: 'Each beam counts', kind: 'switch', rays: ['bresenham', 'traversal'] },
  { name: 'hit_radius', label: 'Hit radius, m', kind: 'number', min: 0, max: 1, rays: ['bresenham'] },
  { name: 'drop_no_return', label: 'Drop beams without return', kind: 'switch' },
  { name: 'p_occupied', label: 'p occupied', kind: 'number', min: 0.5, max: 1 },
  { name: 'p_free', label: 'p free', kind: 'number', min: 0, max: 0.5 },
  { name: 'obstacle_thickness', label: 'Obstacle depth, m', kind: 'number', min: 0, max: 10 },
];

interface Field {
  setting: Setting;
  control: HTMLInputElement | HTMLSelectElement;
  row: HTMLElement;
  mark: HTMLElement;
}

export class SettingsForm {
  private readonly fields: Field[];
  readonly element: HTMLElement;

  /** @param config the session's settings */
  constructor(private readonly config: MapConfig) {
    this.fields = kSettings.map((setting) => this.fieldOf(setting));
    this.element = el('div', { class: 'tool-settings' }, ...this.fields.map(({ row }) => row));
    this.element.addEventListener('input', () => this.update());
    this.reset();
  }

  /** Resets all fields to the session's settings. */
  reset(): void {
    for (const { setting, control } of this.fields) put(control, this.config[setting.name]);
    this.update();
  }

  /** The settings that differ from the session's. */
  get changes(): WeaveRequest {
    const changed = this.fields.filter((field) => this.matters(field) && this.differs(field));
    return Object.fromEntries(changed.map(({ setting, control }) => [setting.name, valueOf(control)]));
  }

  private fieldOf(setting: Setting): Field {
    const { name, label, kind, min = 0, max = 1 } = setting;
    const control =
      kind === 'number'
        ? numberInput(name, null, { min, max })
        : kind === 'rays'
          ? selectOf(name, kRayModels)
          : checkbox(name, false);
    const mark = el('span', { class: 'tool-mark', id: `mark-${name}` });
    control.setAttribute('aria-describedby', mark.id);
    return { setting, control, mark, row: el('div', {}, labelled(label, control), mark) };
  }

  private update(): void {
    for (const field of this.fields) {
      // Browsers do not validate disabled fields.
      field.row.hidden = field.control.disabled = !this.matters(field);
      const now = this.config[field.setting.name];
      field.row.classList.toggle('changed', this.differs(field));
      setText(field.mark, this.differs(field) ? `Changed; the session has ${wordOf(now)}` : '');
    }
  }

  private matters({ setting }: Field): boolean {
    if (this.config[setting.name] === undefined) return false;
    const rays = this.fields.find(({ setting: { kind } }) => kind === 'rays')?.control.value ?? '';
    return setting.rays === undefined || setting.rays.includes(rays);
  }

  private differs({ setting, control }: Field): boolean {
    const now = this.config[setting.name];
    return now !== undefined && valueOf(control) !== now;
  }
}

function put(control: Field['control'], value: MapConfig[string] | undefined): void {
  if (control instanceof HTMLInputElement && control.type === 'checkbox') control.checked = value === true;
  else control.value = String(value ?? '');
}

function valueOf(control: Field['control']): number | string | boolean {
  if (control instanceof HTMLSelectElement) return control.value;
  return control.type === 'checkbox' ? control.checked : control.valueAsNumber;
}

function wordOf(value: MapConfig[string] | undefined): string {
  if (typeof value === 'boolean') return value ? 'yes' : 'no';
  return kRayModels.find(([name]) => name === value)?.[1] ?? String(value);
}

/** "cell_size 0.1, ray_model traversal": the differences between two sets of settings. */
export function describeChanges(config: MapConfig, from: MapConfig): string {
  const changed = Object.entries(config).filter(([name, value]) => from[name] !== value);
  if (changed.length === 0) return 'session settings';
  return changed.map(([name, value]) => `${name} ${String(value)}`).join(', ');
}
