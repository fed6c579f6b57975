/** Servers of PostgreSQL for benches: with a socket in a temporary directory, and without a port. */
import { execFileSync, spawn } from 'node:child_process';
import { chownSync, mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { ended } from '../e2e/programs.mjs';
import { processorSeconds } from './report/process_use.mjs';

const kVersions = '/usr/lib/postgresql';
const kPrograms = join(kVersions, readdirSync(kVersions).sort((a, b) => b - a)[0], 'bin');
const kIsRoot = process.getuid() === 0; // PostgreSQL does not run as root

export class PostgresServer {
  /** Starts a server, or a standby of `primary`, which waits for it at each commit from then on. */
  static async start(primary = undefined) {
    const directory = mkdtempSync(join(tmpdir(), 'scanloom-postgres-'));
    if (kIsRoot) chownSync(directory, ...['-u', '-g'].map((of) => Number(output('id', [of, 'postgres']))));
    const data = join(directory, 'data');
    if (primary) {
      run('pg_basebackup', ['-D', data, '-h', primary.directory, '-U', 'scanloom', '-R', '-c', 'fast']);
    } else {
      run('initdb', ['-D', data, '-U', 'scanloom', '-A', 'trust', '-E', 'UTF8', '--locale', 'C']);
    }
    const settings = ['cluster_name=standby', 'shared_buffers=128MB', 'max_wal_size=4GB'];
    const [program, options] = command('postgres', ['-D', data, '-k', directory, '-h', '']);
    const child = spawn(program, [...options, ...settings.flatMap((setting) => ['-c', setting])], {
      stdio: ['ignore', 'ignore', 'pipe'],
    });
    const lines = createInterface({ input: child.stderr });
    await new Promise((resolve, reject) => {
      lines.on('line', (line) => line.includes('ready to accept') && resolve());
      child.once('exit', (code) => reject(new Error(`PostgreSQL ended with ${code} before it was ready`)));
    });
    const server = new PostgresServer(child, directory);
    if (primary) {
      primary.query("ALTER SYSTEM SET synchronous_standby_names = 'standby'");
      primary.query('SELECT pg_reload_conf()');
      while (primary.query("SELECT count(*) FROM pg_stat_replication WHERE sync_state = 'sync'") !== '1');
    }
    return server;
  }

  constructor(child, directory) {
    Object.assign(this, { child, directory, databases: 0 });
  }

  /** Creates an empty database. @returns its address for --store */
  newDatabase() {
    const name = `db${++this.databases}`;
    this.query(`CREATE DATABASE ${name}`);
    return `postgresql://scanloom@/${name}?host=${this.directory}`;
  }

  /** @returns the first value of a query */
  query(text) {
    return output(join(kPrograms, 'psql'), ['-h', this.directory, '-U', 'scanloom', '-d', 'postgres', '-Atc', text]);
  }

  /** @returns what all its processes have used */
  processorSeconds() {
    return processorSeconds(this.child.pid);
  }

  async stop() {
    const end = ended(this.child);
    this.child.kill('SIGQUIT');
    await end;
    rmSync(this.directory, { recursive: true, force: true });
  }
}

/** @returns the program to start, and its arguments */
function command(program, options) {
  const path = join(kPrograms, program);
  const user = ['--reuid', 'postgres', '--regid', 'postgres', '--clear-groups'];
  return ['setpriv', ['--pdeathsig', 'QUIT', ...(kIsRoot ? user : []), path, ...options]];
}

function run(program, options) {
  const [path, all] = command(program, options);
  execFileSync(path, all, { cwd: '/', stdio: ['ignore', 'ignore', 'inherit'] });
}

function output(program, options) {
  return execFileSync(program, options, { encoding: 'utf8' }).trim();
}
