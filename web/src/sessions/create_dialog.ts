/** The dialog that creates a session: its name, and the settings that cannot be changed later. */
import { createSession, kRayModels, type RayModel } from '../api/manage';
import type { Session } from '../api/types';
import { el } from '../dom';
import { FormDialog } from './form_dialog';

/** The hyphen is escaped for the `v` flag, with which browsers parse patterns. */
const kNamePattern = '[A-Za-z0-9_\\-]{1,64}';
const kNameRule = '1 to 64 letters A\u2013Z, digits, _ or -';
const kCellRange = { min: 0.01, max: 1, usual: 0.05 };
const kCellRule = `${kCellRange.min} to ${kCellRange.max}; small cells need more memory.`;

const kRayModelTexts: Record<RayModel, [title: string, text: string]> = {
  inverse_sensor_model: ['Inverse sensor model', 'Updates every cell in the cone of a beam. The default.'],
  bresenham: ['Bresenham', 'Updates only the cells of a thin line to the hit. The fastest.'],
  traversal: ['Traversal', 'Updates every cell that the beam crosses.'],
};

export class CreateDialog {
  private readonly dialog: FormDialog;
  private readonly name: HTMLInputElement;
  private readonly cellSize: HTMLInputElement;
  private readonly models: HTMLInputElement[];

  constructor(created: (session: Session) => void) {
    this.name = nameField();
    this.cellSize = cellField();
    this.models = kRayModels.map(modelField);
    const fields = [
      el('label', { for: 'new-name' }, 'Name'),
      this.name,
      el('p', { id: 'new-name-rule', class: 'quiet' }, `${kNameRule}.`),
      el('label', { for: 'new-cell' }, 'Cell size, metres'),
      this.cellSize,
      el('p', { id: 'new-cell-rule', class: 'quiet' }, kCellRule),
      el('fieldset', {}, el('legend', {}, 'Ray model'), ...this.models.map(withText)),
    ];
    this.dialog = new FormDialog(
      { title: 'New session', submit: 'Create', busy: 'Creating\u2026' },
      fields,
      async (signal) => created(await createSession(this.request(), signal)),
    );
  }

  open(): void {
    this.name.value = '';
    this.dialog.open(this.name);
  }

  private request(): Parameters<typeof createSession>[0] {
    const chosen = this.models.findIndex(({ checked }) => checked);
    const rayModel = kRayModels[chosen] ?? kRayModels[0];
    return { name: this.name.value, cellSize: this.cellSize.valueAsNumber, rayModel };
  }
}

function nameField(): HTMLInputElement {
  return el('input', {
    id: 'new-name',
    required: '',
    pattern: kNamePattern,
    maxlength: '64',
    title: kNameRule,
    autocomplete: 'off',
    autocapitalize: 'off',
    spellcheck: 'false',
    'aria-describedby': 'new-name-rule',
  });
}

function cellField(): HTMLInputElement {
  return el('input', {
    id: 'new-cell',
    type: 'number',
    required: '',
    min: String(kCellRange.min),
    max: String(kCellRange.max),
    step: 'any',
    value: String(kCellRange.usual),
    inputmode: 'decimal',
    'aria-describedby': 'new-cell-rule',
  });
}

function modelField(model: RayModel, index: number): HTMLInputElement {
  const field = el('input', { type: 'radio', name: 'new-model', id: `new-${model}`, value: model });
  field.setAttribute('aria-describedby', `new-${model}-text`);
  field.defaultChecked = index === 0;
  return field;
}

function withText(field: HTMLInputElement, index: number): HTMLElement {
  const [title, text] = kRayModelTexts[kRayModels[index] ?? kRayModels[0]];
  const label = el('label', { for: field.id }, title);
  return el('div', { class: 'choice' }, field, label, el('span', { id: `${field.id}-text`, class: 'quiet' }, text));
}
