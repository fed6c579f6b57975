/** What figures were measured on. */
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { arch, cpus, loadavg, release, totalmem } from 'node:os';

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
  };
}

export function inWords(of) {
  return `${of.cores} cores of ${of.processor}, ${of.memory_gib} GiB, ${of.system}, Linux ${of.kernel}, ${of.compiler}, load average ${of.load_average.toFixed(1)} at the start`;
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
