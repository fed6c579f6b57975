/** Draws a grid of round lengths with the map's origin and axes over the cells. */
import VectorLayer from 'ol/layer/Vector';
import type RenderEvent from 'ol/render/Event';
import VectorSource from 'ol/source/Vector';
import { roundLength } from '../format';
import type { Theme } from '../theme';
import { kOrder } from './order';
import { scaleStep } from './scale';

/** Largest distance between lines, pixels. */
const kSpacingPx = 120;
const kArrowPx = 40;
const kHeadPx = 5;
const kLineOpacity = 0.14;
const kFont = 'system-ui, sans-serif';

/** Converts metres along one axis to canvas pixels. */
type Along = (metres: number) => number;

/** One drawing of the grid. */
interface Sheet {
  canvas: CanvasRenderingContext2D;
  pixelRatio: number;
  x: Along;
  y: Along;
  /** Distance between two lines, metres. */
  step: number;
  /** The visible extent, metres. */
  extent: [minX: number, minY: number, maxX: number, maxY: number];
}

export class GridLayer {
  readonly layer = new VectorLayer({
    source: new VectorSource(),
    zIndex: kOrder.grid,
    updateWhileAnimating: true,
    updateWhileInteracting: true,
  });

  constructor(private theme: Theme) {
    this.layer.on('prerender', (event) => this.draw(event));
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.layer.changed();
  }

  private draw({ context, frameState }: RenderEvent): void {
    if (!frameState?.extent) return;
    const canvas = context as CanvasRenderingContext2D;
    const { pixelRatio, viewState, size } = frameState;
    const { resolution, center } = viewState;
    const [width = 0, height = 0] = size;
    const [middleX = 0, middleY = 0] = center;
    const sheet: Sheet = {
      ...{ canvas, pixelRatio },
      x: (metres) => ((metres - middleX) / resolution + width / 2) * pixelRatio,
      y: (metres) => ((middleY - metres) / resolution + height / 2) * pixelRatio,
      step: scaleStep(resolution, kSpacingPx).metres,
      extent: frameState.extent as Sheet['extent'],
    };
    canvas.save();
    this.drawLines(sheet);
    this.drawAxes(sheet);
    this.drawNumbers(sheet);
    canvas.restore();
  }

  private drawLines({ canvas, pixelRatio, x, y, step, extent: [minX, minY, maxX, maxY] }: Sheet): void {
    canvas.beginPath();
    for (const metres of multiples(minX, maxX, step)) line(canvas, [x(metres), y(minY)], [x(metres), y(maxY)]);
    for (const metres of multiples(minY, maxY, step)) line(canvas, [x(minX), y(metres)], [x(maxX), y(metres)]);
    canvas.globalAlpha = kLineOpacity;
    canvas.strokeStyle = this.theme.ink;
    canvas.lineWidth = pixelRatio;
    canvas.stroke();
    canvas.globalAlpha = 1;
  }

  /** Draws each axis across the view, with an arrow in its direction at the origin. */
  private drawAxes({ canvas, pixelRatio, x, y, extent: [minX, minY, maxX, maxY] }: Sheet): void {
    const origin: Pixel = [x(0), y(0)];
    const arrow = kArrowPx * pixelRatio;
    const axes: [colour: string, from: Pixel, to: Pixel, direction: Pixel, name: string][] = [
      [this.theme.axisX, [x(minX), y(0)], [x(maxX), y(0)], [1, 0], 'x'],
      [this.theme.axisY, [x(0), y(minY)], [x(0), y(maxY)], [0, -1], 'y'],
    ];
    for (const [colour, from, to, direction, name] of axes) {
      canvas.strokeStyle = canvas.fillStyle = colour;
      canvas.lineWidth = pixelRatio;
      canvas.beginPath();
      line(canvas, from, to);
      canvas.stroke();
      drawArrow(canvas, origin, direction, arrow, pixelRatio);
      const tip: Pixel = [origin[0] + direction[0] * arrow, origin[1] + direction[1] * arrow];
      this.write(canvas, name, [tip[0] + 8 * pixelRatio, tip[1] - 8 * pixelRatio], colour, pixelRatio);
    }
    canvas.beginPath();
    canvas.arc(...origin, 3.5 * pixelRatio, 0, 2 * Math.PI);
    canvas.fillStyle = this.theme.ink;
    canvas.fill();
  }

  /** Draws metres along the axes, where these are in view. */
  private drawNumbers({ canvas, pixelRatio, x, y, step, extent: [minX, minY, maxX, maxY] }: Sheet): void {
    const offset = 9 * pixelRatio;
    for (const metres of multiples(minX, maxX, step)) {
      if (metres !== 0) this.write(canvas, named(metres), [x(metres), y(0) + offset], this.theme.ink, pixelRatio);
    }
    for (const metres of multiples(minY, maxY, step)) {
      const at: Pixel = [x(0) - offset / 2, y(metres)];
      if (metres !== 0) this.write(canvas, named(metres), at, this.theme.ink, pixelRatio, 'right');
    }
  }

  private write(
    canvas: CanvasRenderingContext2D,
    text: string,
    at: Pixel,
    colour: string,
    pixelRatio: number,
    align: CanvasTextAlign = 'center',
  ): void {
    canvas.font = `600 ${11 * pixelRatio}px ${kFont}`;
    canvas.textBaseline = 'middle';
    canvas.textAlign = align;
    canvas.lineJoin = 'round';
    canvas.lineWidth = 3 * pixelRatio;
    canvas.strokeStyle = this.theme.halo;
    canvas.fillStyle = colour;
    canvas.strokeText(text, ...at);
    canvas.fillText(text, ...at);
  }
}

type Pixel = [x: number, y: number];

/** Multiples of the step from `low` to `high`. */
function multiples(low: number, high: number, step: number): number[] {
  const first = Math.ceil(low / step);
  const count = Math.floor(high / step) - first + 1;
  return Array.from({ length: Math.max(0, count) }, (_, index) => (first + index) * step);
}

/** "5 m", "−0.5 m". */
function named(metres: number): string {
  return roundLength(metres).replace('-', '\u2212');
}

function line(canvas: CanvasRenderingContext2D, from: Pixel, to: Pixel): void {
  canvas.moveTo(...from);
  canvas.lineTo(...to);
}

function drawArrow(
  canvas: CanvasRenderingContext2D,
  [x, y]: Pixel,
  [dx, dy]: Pixel,
  length: number,
  pixelRatio: number,
): void {
  const head = kHeadPx * pixelRatio;
  const tip: Pixel = [x + dx * length, y + dy * length];
  canvas.lineWidth = 2.5 * pixelRatio;
  canvas.beginPath();
  line(canvas, [x, y], tip);
  canvas.stroke();
  canvas.beginPath();
  canvas.moveTo(tip[0] + dx * head, tip[1] + dy * head);
  canvas.lineTo(tip[0] - dx * head - dy * head, tip[1] - dy * head + dx * head);
  canvas.lineTo(tip[0] - dx * head + dy * head, tip[1] - dy * head - dx * head);
  canvas.fill();
}
