// A copy of ./scanloom without sources, so that every build fails, and programs in the place of those that it calls.
import { spawnSync } from 'node:child_process';
import { copyFileSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after } from 'node:test';

export const source = resolve(import.meta.dirname ?? new URL('.', import.meta.url).pathname, '../..');

/** The folder of the copy, which is removed after the tests of the file that imports it. */
export const place = mkdtempSync(join(tmpdir(), 'scanloom-script-test.'));
after(() => rmSync(place, { recursive: true, force: true }));

mkdirSync(join(place, 'tests/bench/projection'), { recursive: true });
mkdirSync(join(place, 'tests/fault'));
for (const name of [
  'scanloom',
  'packages.txt',
  'tests/bench/bench.sh',
  'tests/lint.sh',
  'tests/test_quality.sh',
  'tests/tiers.sh',
  'tests/fault/rows.cpp',
  'tests/bench/projection_bench.cpp',
  'tests/bench/projection/peers.cpp',
])
  copyFileSync(join(source, name), join(place, name));

/** All packages are installed. */
export const debian = { 'dpkg-query': 'for package; do echo "installed $package"; done' };

/** Runs the script. */
export const scanloom = (...words) => scanloomWith({}, ...words);

/** Runs the script with these one-line programs first in the PATH. */
export const scanloomWith = (programs, ...words) =>
  spawnSync(join(place, 'scanloom'), words, {
    encoding: 'utf8',
    stdio: ['ignore', 'pipe', 'pipe'],
    env: withPrograms(programs),
  });

/** The environment with these programs first in the PATH. */
export const withPrograms = (programs) => {
  const bin = join(place, 'bin');
  rmSync(bin, { recursive: true, force: true });
  mkdirSync(bin);
  for (const [name, line] of Object.entries(programs)) {
    writeFileSync(join(bin, name), `#!/bin/sh\n${line}\n`, { mode: 0o755 });
  }
  return { ...process.env, PATH: `${bin}:${process.env.PATH}` };
};
