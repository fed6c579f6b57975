/** Settings of the display: light or dark, the palette, and the list of keyboard shortcuts. */
import { byId } from '../dom';
import type { Keys } from '../keys';
import { kPalettes, kSchemes, type Settings, type SettingsStore } from '../settings';

export class DisplayPanel {
  private readonly fields = {
    scheme: byId('scheme', HTMLSelectElement),
    palette: byId('palette', HTMLSelectElement),
    singleKeys: byId('single-keys', HTMLInputElement),
    keysOpen: byId('keys-open', HTMLButtonElement),
    keys: byId('keys', HTMLDialogElement),
    keysBody: byId('keys-body', HTMLElement),
  };

  constructor(
    settings: SettingsStore,
    private readonly keys: Keys,
  ) {
    const { scheme, palette, singleKeys, keysOpen } = this.fields;
    scheme.addEventListener('change', () => {
      settings.change({ scheme: kSchemes.find((each) => each === scheme.value) ?? 'auto' });
    });
    palette.addEventListener('change', () => {
      settings.change({ palette: kPalettes.find((each) => each === palette.value) ?? 'standard' });
    });
    singleKeys.addEventListener('change', () => settings.change({ keys: singleKeys.checked }));
    keysOpen.addEventListener('click', () => this.showKeys());
    keys.bind({ key: '?', does: 'lists the keyboard shortcuts', run: () => this.showKeys() });
    settings.listen((now) => this.show(now));
    this.show(settings.get());
  }

  private show({ scheme, palette, keys }: Settings): void {
    this.fields.scheme.value = scheme;
    this.fields.palette.value = palette;
    this.fields.singleKeys.checked = keys;
  }

  private showKeys(): void {
    this.fields.keysBody.replaceChildren(this.keys.describe());
    this.fields.keys.showModal();
  }
}
