/** Light or dark, the palette, and the list of keys. */
import type { Keys } from '../keys';
import { kPalettes, kSchemes, type Settings, type SettingsStore } from '../settings';

export interface DisplayFields {
  scheme: HTMLSelectElement;
  palette: HTMLSelectElement;
  keysOpen: HTMLButtonElement;
  keys: HTMLDialogElement;
  keysBody: HTMLElement;
}

export class DisplayPanel {
  constructor(
    private readonly fields: DisplayFields,
    settings: SettingsStore,
    private readonly keys: Keys,
  ) {
    const { scheme, palette, keysOpen } = fields;
    scheme.addEventListener('change', () => {
      settings.change({ scheme: kSchemes.find((each) => each === scheme.value) ?? 'auto' });
    });
    palette.addEventListener('change', () => {
      settings.change({ palette: kPalettes.find((each) => each === palette.value) ?? 'standard' });
    });
    keysOpen.addEventListener('click', () => this.showKeys());
    keys.bind({ key: '?', does: 'lists the keys', run: () => this.showKeys() });
    settings.listen((now) => this.show(now));
    this.show(settings.get());
  }

  private show({ scheme, palette }: Settings): void {
    this.fields.scheme.value = scheme;
    this.fields.palette.value = palette;
  }

  private showKeys(): void {
    this.fields.keysBody.replaceChildren(this.keys.describe());
    this.fields.keys.showModal();
  }
}
