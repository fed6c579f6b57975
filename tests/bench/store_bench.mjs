/**
 * The cost of a scan with the log in a directory, in PostgreSQL, and in PostgreSQL with a synchronous standby for one
 * server and for three, in turn.
 *
 *   SCANLOOM_BIN_DIR=build/bin node tests/bench/store_bench.mjs build/bench/store.json [--quick]
 *
 * Everything runs on one machine: robots, servers, PostgreSQL and its standby. Median of the rounds. Processor times
 * are those of the whole run, with connecting and verification.
 */
import { writeFileSync } from 'node:fs';
import { load, startServer } from './load_runs.mjs';
import { PostgresServer } from './postgres_server.mjs';
import { announce, fullOrQuick, operands } from './report/arguments.mjs';
import { describe, machineWithStore } from './report/machine.mjs';
import { processorSeconds } from './report/process_use.mjs';
import { table, threeDigits } from './report/table.mjs';

const kSeconds = fullOrQuick(10, 2);
const kRounds = fullOrQuick(3, 1);
const kScan = { world: 'room', 'cell-size': 0.05, batch: 10, verify: 'counts', keep: true };
const kLoads = [
  ['2,000 scans/s', { robots: 20, rate: 100 }],
  ['as fast as they may', { robots: 128, rate: 0 }],
  ['1,000 robots at 10 Hz', { robots: 1000, sessions: 100, rate: 10, batch: 1 }],
];

const [file] = operands;
announce('store', '8 minutes', '1 minute');
const on = machineWithStore();
const alone = await PostgresServer.start();
const primary = await PostgresServer.start();
const standby = await PostgresServer.start(primary);
const stores = [
  { name: 'directory (RocksDB)' },
  { name: 'PostgreSQL, no standby', primary: alone, options: ['--allow-unreplicated'] },
  { name: 'PostgreSQL, synchronous standby', primary, standby },
  { name: 'PostgreSQL, synchronous standby, three servers', primary, standby, servers: 3 },
];
const runs = [];
try {
  for (let round = 0; round < kRounds; ++round) {
    for (const store of stores) {
      for (const [name, options] of kLoads) runs.push(await measure(store, name, options));
    }
  }
} finally {
  for (const server of [standby, primary, alone]) await server.stop();
}
const rows = kLoads.flatMap(([name]) => stores.map((store) => median(name, store.name)));
writeFileSync(file, `${JSON.stringify({ machine: on, rows, runs }, null, 2)}\n`);
printTable();

async function measure(store, name, options) {
  const database = store.primary?.newDatabase();
  const servers = [];
  try {
    while (servers.length < (store.servers ?? 1)) servers.push(await startServer(store.options, database));
    const used = () => [
      servers.reduce((sum, server) => sum + processorSeconds(server.child.pid), 0),
      store.primary?.processorSeconds(),
      store.standby?.processorSeconds(),
    ];
    const before = used();
    const run = await load(servers, { duration: kSeconds, ...kScan, ...options });
    const [ofServers, ofPrimary, ofStandby] = used().map((seconds, n) =>
      seconds === undefined ? undefined : ((seconds - before[n]) * 1e6) / run.scans.acknowledged,
    );
    const ack = run.ack_from_sending;
    return {
      load: name,
      store: store.name,
      scans_per_second: run.scans.acknowledged_per_second,
      server_us: ofServers,
      primary_us: ofPrimary,
      standby_us: ofStandby,
      ack_p50_ms: ack.p50_ms,
      ack_p99_ms: ack.p99_ms,
    };
  } finally {
    for (const server of servers) await server.stop();
  }
}

/** @returns the median of each figure of a store under a load */
function median(load, store) {
  const all = runs.filter((run) => run.load === load && run.store === store);
  const middle = (key) => all.map((run) => run[key]).sort((a, b) => a - b)[Math.floor(all.length / 2)];
  const figures = Object.keys(all[0]).filter((key) => typeof all[0][key] === 'number');
  return { load, store, ...Object.fromEntries(figures.map((key) => [key, middle(key)])) };
}

function printTable() {
  const figure = (value) => (value === undefined ? '' : threeDigits(value));
  console.log(describe(on), '\n');
  console.log(
    table(
      ['', 'scans/s', 'servers, us a scan', 'primary', 'standby', 'ack p50, ms', 'p99, ms'],
      rows.map((row) => [
        `${row.load}: ${row.store}`,
        row.scans_per_second.toFixed(0),
        ...[row.server_us, row.primary_us, row.standby_us, row.ack_p50_ms, row.ack_p99_ms].map(figure),
      ]),
    ),
  );
  const [directory, , replicated] = rows.slice(stores.length); // as fast as they may
  console.log(
    `\nas fast as they may: server with PostgreSQL and a standby compared with a directory: ${(replicated.server_us / directory.server_us).toFixed(2)} times (aim: at most 1.3); primary ${threeDigits(replicated.primary_us)} us a scan (aim: below 6)`,
  );
  console.log(`written to ${file}`);
}
