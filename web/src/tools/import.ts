/** Creates a session from a ROS map: its description and its image, chosen or dropped on the page. */
import { hashOfSession } from '../address';
import { importMap, type RosMap } from '../api/import';
import { el, setText } from '../dom';
import { isTouch } from '../pointing';
import { button, checkbox, choice, labelled, numberInput, selectOf } from './fields';
import { NewestOnly } from './newest_only';
import { Outcome } from './outcome';
import { kRayModels } from './ray_models';
import type { Tool } from './toolbox';

/** The server's limit. */
const kNamePattern = '[A-Za-z0-9_\\-]{1,64}';
const kNameLengthMax = 64;
const kMegabyte = 1_000_000;

export function importTool(): Tool {
  return {
    id: 'import',
    title: 'Import a map',
    key: 'i',
    does: 'makes a session from a ROS map',
    icon: 'M8.5 2.5h5v11h-5M1.5 8h8M6.5 5l3 3-3 3',
    withoutMap: true,
    open: (card, signal) => void new ImportCard(card, signal),
  };
}

class ImportCard {
  private readonly yaml = el('input', { type: 'file', name: 'yaml', accept: '.yaml,.yml', required: '' });
  private readonly image = el('input', { type: 'file', name: 'image', accept: '.pgm,.png', required: '' });
  private readonly name = el('input', { type: 'text', name: 'name', pattern: kNamePattern, required: '' });
  private readonly localizeOnly = checkbox('localize_only', false);
  private readonly settings = [
    numberInput('cell_size', null, { min: 0.01, max: 1, empty: 'from the map' }),
    numberInput('p_occupied', null, { min: 0.5, max: 1, empty: 'default' }),
    numberInput('p_free', null, { min: 0, max: 0.5, empty: 'default' }),
    selectOf('ray_model', [['', 'Default'], ...kRayModels]),
  ];
  private readonly send = el('button', { class: 'tool-button primary' }, 'Import');
  private readonly cancel = button('Cancel', () => this.giveUp());
  private readonly progress = el('progress', { 'aria-label': 'Import' });
  private readonly outcome = new Outcome();
  private readonly task: NewestOnly;
  private nameIsOwn = false;

  constructor(card: HTMLElement, signal: AbortSignal) {
    this.task = new NewestOnly(
      signal,
      (busy) => this.showBusy(busy),
      (error) => this.outcome.complain(error),
    );
    this.name.autocomplete = 'off';
    this.name.title = 'Letters, digits, _ and -, at most 64';
    this.fill(card);
    this.takeDrops(card, signal);
    this.showBusy(false);
    this.yaml.focus();
  }

  private fill(card: HTMLElement): void {
    const [cellSize, occupied, free, rays] = this.settings;
    if (!cellSize || !occupied || !free || !rays) return;
    const form = el(
      'form',
      { class: 'tool-form' },
      labelled('map.yaml', this.yaml),
      labelled('PGM or PNG', this.image),
      labelled('New session', this.name),
      choice('Localize only: the map does not change', this.localizeOnly),
      el(
        'details',
        {},
        el('summary', {}, 'Settings of the session'),
        labelled('Cell, m', cellSize),
        labelled('p occupied', occupied),
        labelled('p free', free),
        labelled('Laser scans', rays),
      ),
      el('div', { class: 'tool-buttons' }, this.send, this.cancel),
      this.progress,
    );
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.submit();
    });
    this.yaml.addEventListener('change', () => this.proposeName());
    this.image.addEventListener('change', () => this.proposeName());
    this.name.addEventListener('input', () => (this.nameIsOwn = this.name.value !== ''));
    const drop = isTouch() ? '' : ', or drop them here';
    const help = `Choose the two files that map_saver writes${drop}.`;
    card.append(el('p', {}, help), form, this.outcome.element);
  }

  /** Accepts drops anywhere on the page: a file that misses the card must not replace the page. */
  private takeDrops(card: HTMLElement, signal: AbortSignal): void {
    document.addEventListener(
      'dragover',
      (event) => {
        event.preventDefault();
        card.classList.add('dropping');
      },
      { signal },
    );
    document.addEventListener('dragleave', () => card.classList.remove('dropping'), { signal });
    document.addEventListener(
      'drop',
      (event) => {
        event.preventDefault();
        card.classList.remove('dropping');
        this.take([...(event.dataTransfer?.files ?? [])]);
      },
      { signal },
    );
    signal.addEventListener('abort', () => card.classList.remove('dropping'));
  }

  private take(files: File[]): void {
    for (const file of files) {
      const field = /\.ya?ml$/i.test(file.name) ? this.yaml : /\.(pgm|png)$/i.test(file.name) ? this.image : null;
      if (field) put(field, file);
      else this.outcome.complain(new Error(`${file.name} is neither a description (.yaml) nor an image (.pgm, .png)`));
    }
    this.proposeName();
  }

  private proposeName(): void {
    const file = this.yaml.files?.[0] ?? this.image.files?.[0];
    if (file && !this.nameIsOwn) this.name.value = nameFrom(file.name);
  }

  private submit(): void {
    const yaml = this.yaml.files?.[0];
    const image = this.image.files?.[0];
    if (!yaml || !image) return;
    const map: RosMap = { yaml, image };
    const given = this.settings.filter(({ value }) => value !== '').map(({ name, value }) => [name, value]);
    const settings = Object.fromEntries(given) as Record<string, string>;
    if (this.localizeOnly.checked) settings['localize_only'] = 'true';
    const size = ((yaml.size + image.size) / kMegabyte).toFixed(1);
    this.task.run(async (signal) => {
      this.outcome.report(`Sending ${size} MB, then the server reads the map\u2026`);
      const session = await importMap(this.name.value, map, settings, signal);
      this.outcome.report(`The session ${session.name} was created.`);
      location.hash = hashOfSession(session.name);
    });
  }

  private giveUp(): void {
    this.task.stop();
    this.outcome.report('Cancelled. The server may already have created the session.');
    this.send.focus();
  }

  private showBusy(busy: boolean): void {
    this.cancel.hidden = this.progress.hidden = !busy;
    this.send.disabled = busy;
    setText(this.send, busy ? 'Importing\u2026' : 'Import');
  }
}

function put(field: HTMLInputElement, file: File): void {
  const files = new DataTransfer();
  files.items.add(file);
  field.files = files.files;
}

/** "Lab 3.yaml" -> "Lab-3": a valid session name. */
export function nameFrom(file: string): string {
  const base = file.replace(/\.[^.]*$/, '').normalize('NFKD');
  return base
    .replace(/[^A-Za-z0-9_-]+/g, '-')
    .replace(/^-+|-+$/g, '')
    .slice(0, kNameLengthMax);
}
