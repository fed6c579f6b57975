/** Resources of a process, from /proc. */
import { readFileSync } from 'node:fs';

const kTicksPerSecond = 100; // of /proc, on every current Linux

/** CPU seconds of a process and of its children, also those that have ended. */
export function processorSeconds(pid) {
  return [...startedBy(pid), pid].reduce((sum, each) => sum + ticks(each), 0) / kTicksPerSecond;
}

/** Memory of a process in bytes: `VmRSS` now, `VmHWM` maximum. */
export function memoryBytes(pid, field = 'VmRSS') {
  return Number(new RegExp(`^${field}:\\s+(\\d+) kB`, 'm').exec(readFileSync(`/proc/${pid}/status`, 'utf8'))[1]) * 1024;
}

function ticks(pid) {
  let stat;
  try {
    stat = readFileSync(`/proc/${pid}/stat`, 'utf8');
  } catch {
    return 0; // it has just ended, and counts for its parent
  }
  const ofItselfAndItsEndedChildren = stat.split(') ')[1].split(' ').slice(11, 15);
  return ofItselfAndItsEndedChildren.reduce((sum, each) => sum + Number(each), 0);
}

function startedBy(pid) {
  return readFileSync(`/proc/${pid}/task/${pid}/children`, 'utf8').split(' ').filter(Boolean).map(Number);
}
