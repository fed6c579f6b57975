/** Parses the text format of Prometheus, https://prometheus.io/docs/instrumenting/exposition_formats, version 0.0.4. */

export interface Sample {
  labels: ReadonlyMap<string, string>;
  value: number;
}

/** The samples of each name. */
export type Samples = ReadonlyMap<string, Sample[]>;

const kName = /^([A-Za-z_:][A-Za-z0-9_:]*)\s*(\{)?/;
const kLabel = /^\s*([A-Za-z_][A-Za-z0-9_]*)\s*=\s*"((?:[^"\\]|\\.)*)"\s*,?/;
const kValue = /^\s*(\S+)(?:\s+-?\d+)?\s*$/;

/** Skips comments and lines that cannot be parsed; all other lines count. */
export function parseMetrics(text: string): Samples {
  const samples = new Map<string, Sample[]>();
  for (const line of text.split('\n')) {
    const read = parseLine(line.trim());
    if (!read) continue;
    const known = samples.get(read.name);
    if (known) known.push(read.sample);
    else samples.set(read.name, [read.sample]);
  }
  return samples;
}

function parseLine(line: string): { name: string; sample: Sample } | null {
  const head = kName.exec(line);
  const name = head?.[1];
  if (!head || name === undefined) return null;
  let rest = line.slice(head[0].length);
  const labels = new Map<string, string>();
  if (head[2]) {
    for (let label = kLabel.exec(rest); label; label = kLabel.exec(rest)) {
      labels.set(label[1] ?? '', unescape(label[2] ?? ''));
      rest = rest.slice(label[0].length);
    }
    const end = /^\s*\}/.exec(rest);
    if (!end) return null;
    rest = rest.slice(end[0].length);
  }
  const value = parseNumber(kValue.exec(rest)?.[1]);
  return value === null ? null : { name, sample: { labels, value } };
}

/** Parses numbers in the notation of Go. */
export function parseNumber(text: string | undefined): number | null {
  switch (text) {
    case undefined:
    case '':
      return null;
    case '+Inf':
    case 'Inf':
      return Infinity;
    case '-Inf':
      return -Infinity;
    case 'NaN':
    case 'Nan':
      return NaN;
    default: {
      const value = Number(text);
      return Number.isNaN(value) ? null : value;
    }
  }
}

function unescape(text: string): string {
  return text.replace(/\\(.)/g, (_, letter: string) => (letter === 'n' ? '\n' : letter));
}
