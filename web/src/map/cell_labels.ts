/** Draws the HIMM counters as numbers in their cells, where cells are large enough. */
import type OlMap from 'ol/Map';
import type RenderEvent from 'ol/render/Event';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import Feature from 'ol/Feature';
import PointGeometry from 'ol/geom/Point';
import Style from 'ol/style/Style';
import { counterColour, type Rgb } from '../layers/palette';
import type { Theme } from '../theme';
import type { CellReader } from './cell_reader';
import { clipTo, type Clip } from './clip';
import { cellAt } from './grid';
import { kOrder } from './order';

/** Size of a cell in pixels that holds two digits. */
export const kCellPxMin = 16;

export class CellLabels {
  /** One feature that is always in view: its renderer draws all labels. */
  private readonly anchor = new Feature(new PointGeometry([0, 0]));
  readonly layer = new VectorLayer({
    source: new VectorSource({ features: [this.anchor] }),
    zIndex: kOrder.labels,
    updateWhileAnimating: true,
    updateWhileInteracting: true,
    visible: false,
  });
  private reader: CellReader | null = null;
  private clip: Clip = { from: 0, to: 1 };

  constructor(
    private readonly map: OlMap,
    private theme: Theme,
  ) {
    this.layer.on('prerender', (event) => this.draw(event));
    this.layer.setStyle(new Style());
  }

  /** @param reader of the counters; null: draw none */
  show(reader: CellReader | null): void {
    this.reader = reader;
    this.layer.setVisible(reader !== null);
  }

  setClip(clip: Clip): void {
    this.clip = clip;
    this.layer.changed();
  }

  /** Redraws when more cells have been loaded. */
  update(): void {
    if (this.reader) this.layer.changed();
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.layer.changed();
  }

  private draw({ context, frameState }: RenderEvent): void {
    const canvas = context as CanvasRenderingContext2D;
    if (!this.reader || !frameState?.extent) return;
    const { extent, pixelRatio, viewState } = frameState;
    const { cellSize } = this.reader;
    const cellPixels = cellSize / viewState.resolution;
    if (cellPixels < kCellPxMin) return;
    const low = cellAt(extent[0] ?? 0, extent[1] ?? 0, cellSize);
    const high = cellAt(extent[2] ?? 0, extent[3] ?? 0, cellSize);
    canvas.save();
    clipTo(canvas, this.clip);
    canvas.font = `${Math.min(13, 0.55 * cellPixels) * pixelRatio}px system-ui, sans-serif`;
    canvas.textAlign = 'center';
    canvas.textBaseline = 'middle';
    canvas.lineJoin = 'round';
    canvas.lineWidth = 3 * pixelRatio;
    for (let j = low.j; j <= high.j; ++j) {
      for (let i = low.i; i <= high.i; ++i) this.label(canvas, i, j, pixelRatio);
    }
    canvas.restore();
  }

  private label(canvas: CanvasRenderingContext2D, i: number, j: number, pixelRatio: number): void {
    if (!this.reader) return;
    const { cellSize } = this.reader;
    const value = this.reader.read({ i, j });
    if (value.kind !== 'counter') return;
    const at = this.map.getPixelFromCoordinate([(i + 0.5) * cellSize, (j + 0.5) * cellSize]);
    const [x = 0, y = 0] = at ?? [];
    const ground = counterColour(this.theme.cells, value.count);
    canvas.strokeStyle = `rgb(${ground.join(' ')})`;
    canvas.fillStyle = inkOn(ground);
    canvas.strokeText(String(value.count), x * pixelRatio, y * pixelRatio);
    canvas.fillText(String(value.count), x * pixelRatio, y * pixelRatio);
  }
}

/** Black or white, whichever has more contrast: luminance by WCAG 2. */
function inkOn(ground: Rgb): string {
  const [red, green, blue] = ground.map((value) => ((value / 255 + 0.055) / 1.055) ** 2.4) as [number, number, number];
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue > 0.18 ? '#000000' : '#ffffff';
}
