/** Resources of a process, from /proc. */
import { readFileSync } from 'node:fs';

const kTicksPerSecond = 100; // of /proc, on every current Linux

/** CPU seconds of a process and of its running children. */
export function processorSeconds(pid) {
  return [pid, ...startedBy(pid)].reduce((sum, each) => sum + ticks(each), 0) / kTicksPerSecond;
}

/** Memory of a process in bytes: `VmRSS` now, `VmHWM` maximum. */
export function memoryBytes(pid, field = 'VmRSS') {
  return Number(new RegExp(`^${field}:\\s+(\\d+) kB`, 'm').exec(readFileSync(`/proc/${pid}/status`, 'utf8'))[1]) * 1024;
}

function ticks(pid) {
  const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1].split(' ');
  return Number(fields[11]) + Number(fields[12]);
}

function startedBy(pid) {
  return readFileSync(`/proc/${pid}/task/${pid}/children`, 'utf8').split(' ').filter(Boolean).map(Number);
}
