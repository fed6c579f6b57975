/** Describes the machine of a measurement. */
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { arch, cpus, loadavg, release, tmpdir, totalmem } from 'node:os';
import { quick } from './arguments.mjs';

export function machine() {
  const processors = cpus();
  return {
    processor: processors[0]?.model ?? arch(),
    cores: processors.length,
    memory_gib: Math.round(totalmem() / 2 ** 30),
    kernel: release(),
    system: system(),
    compiler: firstLine('c++', ['--version']),
    load_average: loadavg()[0],
    quick,
  };
}

/** Describes also the disk of the servers' stores. */
export function machineWithStore() {
  return { ...machine(), store: fileSystemOf(tmpdir()) };
}

export function describe(of) {
  const store = of.store
    ? `, stores in ${of.store.directory} on ${of.store.kind} of ${of.store.gib} GiB (${of.store.device})`
    : '';
  return `${of.cores} cores of ${of.processor}, ${of.memory_gib} GiB${store}, ${of.system}, Linux ${of.kernel}, ${of.compiler}, load average ${of.load_average.toFixed(1)} at the start${of.quick ? '; a quick run' : ''}`;
}

function fileSystemOf(directory) {
  const [device, kind, bytes] = execFileSync('df', ['--block-size=1', '--output=source,fstype,size', directory], {
    encoding: 'utf8',
  })
    .split('\n')[1]
    .trim()
    .split(/\s+/);
  return { directory, device, kind, gib: Math.round(Number(bytes) / 2 ** 30) };
}

function system() {
  try {
    return /PRETTY_NAME="(.*)"/.exec(readFileSync('/etc/os-release', 'utf8'))?.[1] ?? 'unknown';
  } catch {
    return 'unknown';
  }
}

function firstLine(program, options) {
  try {
    return execFileSync(program, options, { encoding: 'utf8' }).split('\n')[0];
  } catch {
    return `${program}: not found`;
  }
}
