// What ./scanloom shows while it builds.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { debian, place, source, withPrograms } from './script_copy.mjs';

// Of 200 parts of the work, the first step is 80, the second 100: 20 for its headers, and 5 for each of the 16 sources that it joins.
const steps = ['Building CXX object pch.hxx.gch', 'Building CXX object one.cxx.o', 'Building CXX object two.cxx.o'];
mkdirSync(join(place, 'build'), { recursive: true });
writeFileSync(join(place, 'build/one.cxx'), '#include "a.cpp"\n'.repeat(16));

/** A shell command that prints the first steps, as ninja does. */
const print = (count) =>
  steps
    .map((text, i) => `echo "[${i + 1}/3] ${text}"`)
    .slice(0, count)
    .join('; ');

test('finished steps count by their weight', () => {
  const progress = `(${print(3)}) >all; weigh_steps build <all >steps.steps; touch steps.log; how_far steps.log 60
    for count in 1 2; do head -n $count all >steps.log; how_far steps.log 60; done
    how_far steps.log 6000; rm steps.steps; how_far steps.log 60`;
  const functions = readFileSync(join(source, 'scanloom'), 'utf8').replace(/^main .*$/m, progress);
  writeFileSync(join(place, 'functions.sh'), functions);
  const result = spawnSync('bash', [join(place, 'functions.sh')], { encoding: 'utf8' });
  assert.equal(
    result.stdout,
    '0 %, 60 s so far\n40 %, about 90 s left\n90 %, about 6 s left\n90 %, about 11 min left\n60 s\n',
    result.stderr,
  );
});

test('on a terminal, the line of a build is updated', async () => {
  const go = join(place, 'go');
  const build = `${print(1)}; while [ ! -e ${go} ]; do sleep 0.01; done`;
  const env = withPrograms({ ...debian, cmake: `case "$*" in *-n) ${print(3)} ;; --build*) ${build} ;; esac` });
  const shown = spawn('script', ['--quiet', '--return', '--command', join(place, 'scanloom build'), '/dev/null'], {
    stdio: ['ignore', 'pipe', 'inherit'],
    env: { ...env, TERM: 'xterm' },
  });
  const ended = once(shown, 'exit');
  let output = '';
  for await (const text of shown.stdout) {
    output += text;
    if (output.includes(' s left')) writeFileSync(go, '');
  }
  assert.deepEqual(await ended, [0, null], output);
  const lines = output.split('\r\x1b[K');
  assert.ok(
    lines.some((line) => /^\.{3} {3}build \(release\): 40 %, about \d+ s left $/.test(line)),
    output,
  );
});
