/**
 * What it costs to put a scan into a map, ours and others', as ratios of one run, beside what we aim at.
 *
 *   node tests/bench/projection_report.mjs build/bench/projection_bench build/bench/projection.json
 *
 * Each benchmark runs kRounds times, all of them mixed, and its median counts: so that what else the machine does meanwhile
 * meets all alike. Times are of the processor, not of the clock.
 */
import { execFileSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { inWords, machine } from './report/machine.mjs';
import { table, threeDigits } from './report/table.mjs';

const kRounds = 5;
/** Mappers; "spans" is a limit, and "fill_poly" knows no occupied cells. */
const kRivals = ['mark_and_clear', 'once_a_scan', 'mrpt'];
/** Those columns whose geometric mean counts; the others only show what noise costs. */
const counts = (column) => !column.includes('+noise');

const aims = {
  meanOverRivals: 6,
  overSpans: 3, // at most, where cells are 0.05 m or finer
  allOverOccupancy: 2, // at most
};

const [program, file] = process.argv.slice(2);
const on = machine();
const times = measure();
const columns = Object.keys(times).map(compare);
const counted = columns.filter((column) => counts(column.name));
const result = {
  machine: on,
  aims,
  mean_over_rivals: Math.exp(counted.reduce((sum, column) => sum + Math.log(column.over_rivals), 0) / counted.length),
  slower_than_a_rival_in: columns.filter((column) => column.over_rivals < 1).map((column) => column.name),
  columns,
};
writeFileSync(file, `${JSON.stringify(result, null, 2)}\n`);
tell();

/** @returns {column: {mapper: microseconds a scan}} */
function measure() {
  const options = [`--benchmark_repetitions=${kRounds}`, '--benchmark_enable_random_interleaving=true', '--benchmark_report_aggregates_only=true', '--benchmark_min_time=0.05', '--benchmark_format=json'];
  const run = JSON.parse(execFileSync(program, options, { encoding: 'utf8', maxBuffer: 2 ** 28, stdio: ['ignore', 'pipe', 'ignore'] }));
  on.instruction_set = run.context.instruction_set;
  const found = {};
  for (const benchmark of run.benchmarks) {
    if (benchmark.aggregate_name !== 'median') continue;
    const [, place, cells, mapper] = benchmark.run_name.split('/');
    found[`${place} ${cells}`] ??= {};
    found[`${place} ${cells}`][mapper] = benchmark.cpu_time;
  }
  return found;
}

function compare(name) {
  const of = times[name];
  const fastest = kRivals.filter((rival) => rival in of).reduce((a, b) => (of[a] <= of[b] ? a : b));
  return {
    name,
    microseconds: of,
    fastest_rival: fastest,
    over_rivals: of[fastest] / of.occupancy,
    over_spans: of.occupancy / of.spans,
    all_over_occupancy: of.all_layers / of.occupancy,
  };
}

function tell() {
  const mappers = Object.keys(columns[0].microseconds);
  console.log(inWords(on), `\ninstructions: ${on.instruction_set}; microseconds a scan, medians of ${kRounds}\n`);
  console.log(table(['', ...mappers], columns.map((column) => [column.name, ...mappers.map((mapper) => threeDigits(column.microseconds[mapper]))])));
  console.log();
  console.log(
    table(
      ['', 'times as fast as', 'the fastest', 'over the spans', 'all layers over occupancy'],
      columns.map((column) => [column.name, threeDigits(column.over_rivals), column.fastest_rival, threeDigits(column.over_spans), threeDigits(column.all_over_occupancy)]),
    ),
  );
  console.log(`\ngeometric mean over the fastest rival: ${threeDigits(result.mean_over_rivals)} (aim: at least ${aims.meanOverRivals})`);
  const isFine = (column) => Number(column.name.split(' ')[1]) <= 0.05;
  tellLimit('over the span limit, cells of 0.05 m and finer', columns.filter(isFine), 'over_spans', aims.overSpans);
  tellLimit('all layers over occupancy', columns, 'all_over_occupancy', aims.allOverOccupancy);
  console.log(`slower than a rival in: ${result.slower_than_a_rival_in.join(', ') || 'no column'}`);
  console.log(`written to ${file}`);
}

function tellLimit(what, among, key, aim) {
  const worst = among.reduce((a, b) => (a[key] >= b[key] ? a : b));
  console.log(`${what}: at most ${threeDigits(worst[key])}, in ${worst.name} (aim: at most ${aim})`);
}
