/** Selection of the layers and overlays, and their legends. */
import { byId, el, setText } from '../dom';
import { isLayerName, kLayerNotes, kLayers, kLayerTitles } from '../layers/layers';
import type { Picture, PictureState } from '../picture';
import type { Settings, SettingsStore } from '../settings';
import { showLegend } from './legend';
import { overlayLegend } from './overlay_legend';

type Switch = { [Key in keyof Settings]: Settings[Key] extends boolean ? Key : never }[keyof Settings];

const kSwitches: [key: Switch, label: string][] = [
  ['robots', 'Robots'],
  ['trails', 'Trails'],
  ['points', 'Newest scans'],
  ['goals', 'Goals and paths'],
  ['frontiers', 'Frontiers'],
  ['landmarks', 'Landmarks'],
  ['poseGraph', 'Pose graph'],
  ['grid', 'Grid, origin and axes'],
  ['counters', 'HIMM counters in cells'],
];

/** Overlays that are available for the present only. */
const kPresentOnly: Switch[] = ['points', 'goals', 'frontiers', 'landmarks', 'poseGraph'];

export class LayersPanel {
  private readonly fields = {
    layers: byId('layers', HTMLElement),
    note: byId('layer-note', HTMLElement),
    legend: byId('legend', HTMLElement),
    opacity: byId('opacity', HTMLInputElement),
    second: byId('second-layer', HTMLSelectElement),
    secondOptions: byId('second-options', HTMLElement),
    secondOpacity: byId('second-opacity', HTMLInputElement),
    secondLegend: byId('second-legend', HTMLElement),
    swipe: byId('mode-swipe', HTMLInputElement),
    over: byId('mode-over', HTMLInputElement),
    overlays: byId('overlays', HTMLElement),
  };
  private readonly radios: HTMLInputElement[];
  private readonly switches = new Map<Switch, HTMLInputElement>();
  private readonly legends = new Map<Switch, HTMLElement>();

  constructor(
    private readonly picture: Picture,
    private readonly settings: SettingsStore,
  ) {
    this.radios = kLayers.map((layer) => this.addRadio(layer, kLayerTitles[layer]));
    this.fields.second.append(
      el('option', { value: '' }, 'None'),
      ...kLayers.map((layer) => el('option', { value: layer }, kLayerTitles[layer])),
    );
    for (const [key, label] of kSwitches) this.addSwitch(key, label);
    this.connect();
    picture.listen(() => this.show(picture.now));
    settings.listen((now) => this.showSwitches(now));
    this.show(picture.now);
    this.showSwitches(settings.get());
  }

  private addRadio(value: string, title: string): HTMLInputElement {
    const radio = el('input', { type: 'radio', name: 'layer', value });
    this.fields.layers.append(el('label', { class: 'choice' }, radio, title));
    radio.addEventListener('change', () => isLayerName(value) && this.picture.change({ layer: value }));
    return radio;
  }

  private addSwitch(key: Switch, label: string): void {
    const box = el('input', { type: 'checkbox', 'data-switch': key });
    this.switches.set(key, box);
    this.fields.overlays.append(el('label', { class: 'choice' }, box, label));
    const legend = overlayLegend(key, label);
    if (legend) {
      this.legends.set(key, legend);
      this.fields.overlays.append(legend);
    }
    box.addEventListener('change', () => this.settings.change({ [key]: box.checked }));
  }

  private connect(): void {
    const { opacity, second, secondOpacity, swipe, over } = this.fields;
    opacity.addEventListener('input', () => this.picture.change({ opacity: opacity.valueAsNumber / 100 }));
    secondOpacity.addEventListener('input', () => {
      this.picture.change({ secondOpacity: secondOpacity.valueAsNumber / 100 });
    });
    second.addEventListener('change', () => {
      this.picture.change({ secondLayer: isLayerName(second.value) ? second.value : null });
    });
    swipe.addEventListener('change', () => this.picture.change({ mode: 'swipe' }));
    over.addEventListener('change', () => this.picture.change({ mode: 'over' }));
  }

  private show({ layer, secondLayer, mode, opacity, secondOpacity }: PictureState): void {
    const { fields } = this;
    for (const radio of this.radios) radio.checked = radio.value === layer;
    setText(fields.note, kLayerNotes[layer]);
    showLegend(fields.legend, layer);
    const second = this.picture.second;
    fields.second.value = secondLayer ?? '';
    fields.secondOptions.hidden = second === null;
    fields.secondLegend.hidden = second === null || second.layer === layer;
    if (second) showLegend(fields.secondLegend, second.layer);
    fields.swipe.checked = mode === 'swipe';
    fields.over.checked = mode === 'over';
    fields.opacity.value = String(Math.round(100 * opacity));
    fields.secondOpacity.value = String(Math.round(100 * secondOpacity));
    fields.secondOpacity.disabled = mode === 'swipe';
    for (const key of kPresentOnly) {
      const box = this.switches.get(key);
      if (box) box.disabled = this.picture.isPast;
    }
  }

  private showSwitches(settings: Settings): void {
    for (const [key, box] of this.switches) box.checked = settings[key];
    for (const [key, legend] of this.legends) legend.hidden = !settings[key];
  }
}
