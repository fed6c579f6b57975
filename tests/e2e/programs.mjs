/** Runs the real server and robot as processes of the test. */
import { spawn } from 'node:child_process';
import { rmSync } from 'node:fs';
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { required } from './environment.mjs';

const kBinDirectory = required('SCANLOOM_BIN_DIR');
/** The viewer's files, as the test sees them. */
const kWeb = process.env.SCANLOOM_WEB_DIR ? ['--web', process.env.SCANLOOM_WEB_DIR] : [];

const running = new Set();
const stores = new Set();

/** Ends all running processes when this program is interrupted. */
export function endWithThisProgram() {
  for (const signal of ['SIGINT', 'SIGTERM']) {
    process.once(signal, () => {
      for (const child of running) child.kill('SIGKILL');
      for (const store of stores) rmSync(store, { recursive: true, force: true, maxRetries: 5 });
      process.exit(130);
    });
  }
}

/** Starts a server on free ports with its own empty store. */
export class Server {
  /** @param database address of a database for the store; otherwise, it is in a temporary directory */
  static async start(options = [], database = undefined) {
    const store = await mkdtemp(join(tmpdir(), 'scanloom-e2e-'));
    stores.add(store);
    const child = start('scanloom-server', [
      ...['--listen', '127.0.0.1:0', '--http', '127.0.0.1:0', '--store', database ?? store, ...kWeb, ...options],
    ]);
    const ready = await readyLine(child);
    return new Server(child, store, ready.robot_port, ready.http_port);
  }

  constructor(child, store, robotPort, httpPort) {
    Object.assign(this, { child, store, robotPort, httpPort });
  }

  get address() {
    return `http://127.0.0.1:${this.httpPort}/`;
  }

  async stop() {
    await stop(this.child);
    await rm(this.store, { recursive: true, force: true });
    stores.delete(this.store);
  }
}

export function startRobot(server, session, robot, source) {
  return start('scanloom-robot', [
    ...['--server', `127.0.0.1:${server.robotPort}`, '--session', session, '--robot', robot, ...source],
  ]);
}

/** @returns the exit code, after the process has ended by itself */
export function ended(child) {
  return new Promise((resolve) => child.once('exit', resolve));
}

/** Terminates the process, and waits until it has ended. */
export async function stop(child) {
  if (child.exitCode !== null || child.signalCode !== null) return;
  const over = ended(child);
  child.kill('SIGTERM');
  await over;
}

export function start(program, args, { stderr = 'inherit' } = {}) {
  const child = spawn(join(kBinDirectory, program), args, { stdio: ['ignore', 'pipe', stderr] });
  running.add(child);
  child.once('exit', () => running.delete(child));
  child.on('error', (error) => console.error(`${program} cannot be started: ${error.message}`));
  return child;
}

function readyLine(child) {
  return new Promise((resolve, reject) => {
    createInterface({ input: child.stdout }).on('line', (line) => {
      const event = JSON.parse(line);
      if (event.event === 'ready') resolve(event);
    });
    child.once('error', reject);
    child.once('exit', (code) => reject(new Error(`scanloom-server ended with ${code} before it was ready`)));
  });
}
