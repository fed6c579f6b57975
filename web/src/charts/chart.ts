/** One small chart: a title, the newest value as text, and the lines, which screen readers skip. */
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { el, setText } from '../dom';
import type { Series } from './history';
import { kHistorySeconds } from './history';

const kHeight = 64;

export interface ChartLine {
  /** Lines of one scale share their axis; the chart shows the axis of the first line. */
  scale: string;
  /** Index into the charts' two colours. */
  colour: 0 | 1;
}

export interface ChartTexts {
  title: string;
  /** Formats the numbers of the axis, short. */
  axis: (value: number) => string;
}

/** Values of the style sheet's properties. */
export interface ChartColours {
  lines: readonly [string, string];
  ink: string;
  grid: string;
}

export class Chart {
  readonly element: HTMLElement;
  private readonly value = el('p', { class: 'chart-value numeric' });
  private readonly frame = el('div', { class: 'chart-frame', 'aria-hidden': 'true' });
  private readonly observer = new ResizeObserver(() => this.resize());
  private plot: uPlot | null = null;
  private data: uPlot.AlignedData = [[]];

  constructor(
    private readonly texts: ChartTexts,
    private readonly lines: ChartLine[],
  ) {
    const title = el('h3', {}, texts.title);
    this.element = el('div', { class: 'chart', 'data-title': texts.title }, title, this.value, this.frame);
    this.observer.observe(this.frame);
  }

  /**
   * @param value the newest value as text
   * @param series one for each line; null where the server does not report the metric
   */
  show(value: string, times: number[], series: Series[] | null): void {
    setText(this.value, value);
    this.frame.hidden = series === null;
    if (series === null) return;
    this.data = [times, ...series];
    this.plot?.setData(this.data);
  }

  /** Recreates the plot, because its colours are part of it. */
  setColours(colours: ChartColours): void {
    this.plot?.destroy();
    this.plot = new uPlot(this.options(colours), this.data, this.frame);
  }

  private resize(): void {
    const width = this.frame.clientWidth;
    if (width > 0) this.plot?.setSize({ width, height: kHeight });
  }

  private options({ lines, ink, grid }: ChartColours): uPlot.Options {
    const scales = [...new Set(this.lines.map(({ scale }) => scale))];
    return {
      width: Math.max(1, this.frame.clientWidth),
      height: kHeight,
      padding: [6, 2, 4, 0],
      cursor: { show: false },
      legend: { show: false },
      scales: {
        x: { time: true, range: (_, __, max) => [max - kHistorySeconds, max] },
        ...Object.fromEntries(scales.map((scale) => [scale, { range: rangeFromZero }])),
      },
      axes: [
        { show: false },
        {
          scale: scales[0] ?? 'y',
          stroke: ink,
          font: '11px system-ui, sans-serif',
          size: 44,
          gap: 4,
          space: 24,
          values: (_, splits) => splits.map(this.texts.axis),
          grid: { stroke: grid, width: 1 },
          ticks: { show: false },
        },
      ],
      series: [
        {},
        ...this.lines.map(({ scale, colour }) => ({
          scale,
          stroke: lines[colour],
          width: 1.5,
          dash: colour === 0 ? [] : [4, 3],
          points: { show: false },
        })),
      ],
    };
  }
}

/** No value here is negative. A constant value is drawn near the bottom, not in the middle. */
function rangeFromZero(_: uPlot, __: number | null, max: number | null): uPlot.Range.MinMax {
  return [0, max === null || max <= 0 ? 1 : max * 1.1];
}
