/** Charts of the server's load in the last minutes; the page polls only while they are open. */
import { fetchMetrics } from '../api/api';
import { Unreachable } from '../api/http';
import { el, setText } from '../dom';
import { poll, type Pace } from '../poll';
import { Chart, type ChartColours, type ChartLine, type ChartTexts } from './chart';
import { History, type Series, type SeriesOfTime } from './history';
import { measure, nothingMeasured, type Measures } from './measures';
import { parseMetrics } from './prometheus';
import * as values from './values';

/** No polls while the page is hidden: showing the page ends the long pause. */
const kPace: Pace = { visibleMs: 2_000, hiddenMs: 3_600_000 };

interface Spec {
  texts: ChartTexts;
  lines: ChartLine[];
  /** The chart has data when the server reports any of these. */
  needs: (keyof Measures)[];
  series: (all: SeriesOfTime) => Series[];
  /** The newest value of each line. */
  format: (...newest: (number | null)[]) => string;
}

const kOneLine: ChartLine[] = [{ scale: 'y', colour: 0 }];

const kSpecs: Spec[] = [
  {
    texts: { title: 'Scans per second', axis: values.short },
    lines: kOneLine,
    needs: ['scans'],
    series: ({ scans }) => [scans],
    format: (scans = null) => values.perSecond(scans),
  },
  {
    texts: { title: 'Ack latency, ms', axis: (seconds) => values.short(seconds * 1000) },
    lines: [kOneLine[0] as ChartLine, { scale: 'y', colour: 1 }],
    needs: ['ack'],
    series: ({ ackMedian, ackSlow }) => [ackMedian, ackSlow],
    format: (median = null, slow = null) => ackText(median, slow),
  },
  {
    texts: { title: 'Queue (bytes dashed)', axis: values.short },
    lines: [
      { scale: 'scans', colour: 0 },
      { scale: 'bytes', colour: 1 },
    ],
    needs: ['inFlight', 'queuedBytes'],
    series: ({ inFlight, queuedBytes }) => [inFlight, queuedBytes],
    format: (inFlight = null, queued = null) => values.both(values.scans(inFlight), values.bytes(queued)),
  },
  {
    texts: { title: 'CPU, % of a core', axis: values.short },
    lines: kOneLine,
    needs: ['cpuSeconds'],
    series: ({ cpu }) => [cpu],
    format: (cpu = null) => values.percent(cpu),
  },
  {
    texts: { title: 'Memory, MB', axis: (bytes) => values.short(bytes / 1e6) },
    lines: kOneLine,
    needs: ['memoryBytes'],
    series: ({ memoryBytes }) => [memoryBytes],
    format: (memory = null) => values.bytes(memory),
  },
];

export class ServerCharts {
  private readonly history = new History();
  private readonly charts = kSpecs.map(({ texts, lines }) => new Chart(texts, lines));
  private readonly state = el('p', { class: 'quiet', role: 'status' });
  private leave: AbortController | null = null;

  constructor(
    private readonly toggle: HTMLButtonElement,
    private readonly body: HTMLElement,
  ) {
    body.append(this.state, ...this.charts.map(({ element }) => element));
    toggle.addEventListener('click', () => (this.leave ? this.close() : this.open()));
  }

  /** Called when the page's colours have changed. */
  takeColours(): void {
    if (!this.leave) return;
    const colours = readColours();
    for (const chart of this.charts) chart.setColours(colours);
  }

  private open(): void {
    this.toggle.setAttribute('aria-expanded', 'true');
    this.body.hidden = false;
    this.leave = new AbortController();
    setText(this.state, 'Loading\u2026');
    this.takeColours();
    void poll(
      (signal) => this.update(signal),
      kPace,
      this.leave.signal,
      (error) => this.settle(error),
    );
  }

  private close(): void {
    this.leave?.abort();
    this.leave = null;
    this.toggle.setAttribute('aria-expanded', 'false');
    this.body.hidden = true;
  }

  private async update(signal: AbortSignal): Promise<void> {
    if (document.hidden) return;
    const samples = parseMetrics(await fetchMetrics(signal));
    this.history.add(measure(samples, Date.now() / 1000));
    this.show();
  }

  private settle(error: unknown): void {
    const was = error instanceof Unreachable ? 'Offline.' : 'The server\u2019s metrics cannot be read.';
    setText(this.state, error === null ? '' : `${was} The charts show the last received values.`);
    this.state.hidden = error === null;
    if (error === null) return;
    this.history.add(nothingMeasured(Date.now() / 1000));
    this.show();
  }

  private show(): void {
    const all = this.history.series();
    this.charts.forEach((chart, index) => {
      const spec = kSpecs[index];
      if (spec) this.fill(chart, spec, all);
    });
  }

  private fill(chart: Chart, { needs, series, format }: Spec, all: SeriesOfTime): void {
    if (!needs.some((need) => this.history.has(need))) return chart.show('not reported by this server', [], null);
    const lines = series(all);
    chart.show(format(...lines.map((line) => line[line.length - 1] ?? null)), all.times, lines);
  }
}

function ackText(median: number | null, slow: number | null): string {
  return values.both(`p50 ${values.milliseconds(median)}`, `p99 ${values.milliseconds(slow)}`);
}

function readColours(): ChartColours {
  const style = getComputedStyle(document.documentElement);
  const colour = (name: string): string => style.getPropertyValue(name).trim();
  return { lines: [colour('--robot-0'), colour('--robot-1')], ink: colour('--ink-quiet'), grid: colour('--line') };
}
