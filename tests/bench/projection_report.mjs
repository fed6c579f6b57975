/**
 * The cost of integrating a scan into a map, for this projection and other mappers, as ratios of one run, with our
 * limits.
 *
 *   node tests/bench/projection_report.mjs build/bench/projection_bench build/bench/projection.json [--quick]
 *
 * Each benchmark runs kRounds times, in random order with the others, and its median counts: other load on the machine
 * then affects all alike. Times are CPU time, not wall time.
 */
import { execFileSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { announce, fullOrQuick, operands } from './report/arguments.mjs';
import { describe, machine } from './report/machine.mjs';
import { table, threeDigits } from './report/table.mjs';

const kRounds = fullOrQuick(5, 3);
const kSeconds = fullOrQuick(0.05, 0.005); // minimum for each benchmark in each round

/** The mappers that are compared with ours, and their short names. */
const kRivals = { once_a_scan: 'Hector', mrpt: 'MRPT', mark_and_clear: 'Nav2' };
/** In the order of the tables. */
const kPlaces = ['room', 'office', 'hall', 'intel', 'fr079', 'room+noise'];

const aims = {
  meanOverRivals: 6,
  overSpans: 3, // maximum, where cells are 0.05 m or finer
  allOverOccupancy: 2, // maximum
};

const [program, file] = operands;
announce('projection', '1 minute', 'half a minute');
const on = machine();
const columns = compared(measure());
/** Columns whose geometric mean counts; the others only show the cost of noise. */
const counted = columns.filter((column) => !column.name.includes('+noise'));
const result = {
  machine: on,
  aims,
  mean_over_rivals: geometricMean('over_rivals'),
  mean_over_rivals_unsaturated: geometricMean('over_rivals_unsaturated'),
  mean_over_fill_poly: geometricMean('over_fill_poly'),
  slower_than_a_rival_in: columns.filter((column) => column.over_rivals < 1).map((column) => column.name),
  columns,
};
writeFileSync(file, `${JSON.stringify(result, null, 2)}\n`);
printTables();

/** @returns {column: {mapper: microseconds a scan}} */
function measure() {
  const options = [
    `--benchmark_repetitions=${kRounds}`,
    '--benchmark_enable_random_interleaving=true',
    '--benchmark_report_aggregates_only=true',
    `--benchmark_min_time=${kSeconds}`,
    '--benchmark_format=json',
  ];
  const run = JSON.parse(
    execFileSync(program, options, { encoding: 'utf8', maxBuffer: 2 ** 28, stdio: ['ignore', 'pipe', 'ignore'] }),
  );
  on.instruction_set = run.context.instruction_set;
  on.mrpt = run.context.mrpt;
  const found = {};
  for (const benchmark of run.benchmarks) {
    if (benchmark.aggregate_name !== 'median') continue;
    const [, place, cells, mapper] = benchmark.run_name.split('/');
    found[`${place} ${cells}`] ??= {};
    found[`${place} ${cells}`][mapper] = benchmark.cpu_time;
  }
  return found;
}

function compared(times) {
  const rank = (name) => kPlaces.indexOf(name.split(' ')[0]) + Number(name.split(' ')[1]); // cells are smaller than 1 m
  const inOrder = Object.entries(times).sort(([a], [b]) => rank(a) - rank(b));
  return inOrder.map(([name, of]) => {
    const fastest = Object.keys(kRivals)
      .filter((rival) => rival in of)
      .reduce((a, b) => (of[a] <= of[b] ? a : b));
    return {
      name,
      microseconds: of,
      fastest_rival: fastest,
      over_rivals: of[fastest] / of.occupancy,
      over_rivals_unsaturated: of[fastest] / of.unsaturated,
      over_fill_poly: of.fill_poly / of.occupancy,
      over_spans: of.occupancy / of.spans,
      all_over_occupancy: of.all_layers / of.occupancy,
    };
  });
}

function geometricMean(key) {
  return Math.exp(counted.reduce((sum, column) => sum + Math.log(column[key]), 0) / counted.length);
}

function printTables() {
  console.log(describe(on), `\ninstructions: ${on.instruction_set}; microseconds a scan, medians of ${kRounds}\n`);
  console.log(timesOf(counted));
  console.log(
    '\nAll except MRPT are reimplementations. fillPoly is not a mapper: it has no occupied cells, and joins the ends of beams\nby straight lines, also across directions without a beam; it shows the cost of filling one polygon.\n',
  );
  const ratio = (what, key) => [what, ...counted.map((column) => threeDigits(column[key]))];
  console.log(
    table(
      ['', ...names(counted)],
      [
        ['the fastest of these: as Hector, MRPT, as Nav2', ...counted.map((column) => kRivals[column.fastest_rival])],
        ratio('Scanloom, times as fast as that', 'over_rivals'),
        ratio('the same, with unsaturated cells', 'over_rivals_unsaturated'),
        ratio('Scanloom, times as fast as fillPoly', 'over_fill_poly'),
        ratio('Scanloom, times as long as the limit', 'over_spans'),
        ratio('all layers, times as long as occupancy', 'all_over_occupancy'),
      ],
    ),
  );
  printNoise();
  console.log(
    `\ngeometric mean over the fastest: ${threeDigits(result.mean_over_rivals)} (aim: at least ${aims.meanOverRivals}); with unsaturated cells ${threeDigits(result.mean_over_rivals_unsaturated)}; over fillPoly ${threeDigits(result.mean_over_fill_poly)}`,
  );
  const isFine = (column) => Number(column.name.split(' ')[1]) <= 0.05;
  printLimit('over the limit, cells of 0.05 m and finer', columns.filter(isFine), 'over_spans', aims.overSpans);
  printLimit('all layers over occupancy', columns, 'all_over_occupancy', aims.allOverOccupancy);
  console.log(`slower than one of them for: ${result.slower_than_a_rival_in.join(', ') || 'no column'}`);
  console.log(`written to ${file}`);
}

function printNoise() {
  const noisy = columns.filter((column) => !counted.includes(column));
  console.log(
    '\nThe room again with noise, 0.02 m of each range and 0.005 rad of each direction (standard deviations): ranges jump from beam to beam\n',
  );
  console.log(timesOf(noisy));
}

/** A row for each mapper, a column for each place. */
function timesOf(places) {
  const rows = Object.entries(mappers()).filter(([mapper]) => mapper in places[0].microseconds);
  return table(
    ['', ...names(places)],
    rows.map(([mapper, label]) => [label, ...places.map((place) => threeDigits(place.microseconds[mapper]))]),
  );
}

function mappers() {
  return {
    bresenham: 'hand-written Bresenham, float',
    once_a_scan: 'each cell once a scan, returns only, as Hector SLAM',
    mrpt: `MRPT ${on.mrpt}, COccupancyGridMap2D`,
    mark_and_clear: "mark and clear, bytes, as Nav2's obstacle layer",
    fill_poly: 'OpenCV fillPoly and subtract',
    occupancy: 'Scanloom, occupancy, exact',
    unsaturated: 'Scanloom, with unsaturated cells',
    all_layers: 'Scanloom, with HIMM and classes',
    spans: 'limit: adding to the same rows of cells',
  };
}

function names(places) {
  return places.map((place) => place.name);
}

function printLimit(what, among, key, aim) {
  const worst = among.reduce((a, b) => (a[key] >= b[key] ? a : b));
  console.log(`${what}: at most ${threeDigits(worst[key])}, in ${worst.name} (aim: at most ${aim})`);
}
