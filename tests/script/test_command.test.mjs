// ./scanloom test and flakes: which tests they run, and what they report.
import assert from 'node:assert/strict';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { debian, place, scanloomWith } from './script_copy.mjs';

test('test WORD runs the tests with this name, and reports that there are none or that some fail', () => {
  mkdirSync(join(place, 'build/tests'), { recursive: true });
  const program = [
    '#!/bin/sh',
    'case $* in',
    '*--gtest_list_tests*=\\*Known\\**|*--gtest_list_tests*:\\*Known\\**) echo Suite. && echo "  Known" ;;',
    '*--gtest_list_tests*) ;;',
    `*) [ ! -e ${join(place, 'broken')} ] ;;`,
    'esac',
  ];
  for (const name of ['core', 'maps', 'memory', 'server', 'recovery', 'http', 'robot', 'system', 'tools', 'faults'])
    writeFileSync(join(place, `build/tests/${name}_test`), program.join('\n'), { mode: 0o755 });
  writeFileSync(
    join(place, 'tests/suite_test.cpp'),
    'TEST(Suite, Known) { helper(); } // of core_test, as TEST(Other, Case)\n',
  );
  const run = (...words) => scanloomWith({ ...debian, cmake: '', ctest: 'echo "Total Tests: 0"' }, 'test', ...words);
  for (const word of ['NONSENSE', 'Known_NONSENSE', 'helper']) {
    const none = run(word);
    assert.equal(none.status, 2, none.stderr);
    assert.equal(none.stderr, `scanloom: no test's name contains '${word}' (--all and --nightly have more tests)\n`);
    assert.equal(none.stdout.includes('build (test)'), word === 'helper', none.stdout); // no source has the other words
  }
  for (const word of ['Known', 'core.Known', 'core.Other+Known']) assert.equal(run(word).status, 0, word);
  assert.match(run('core.Known').stdout, /^core_test: 1 tests$/m);
  assert.doesNotMatch(run('core.Known').stdout, /maps_test/);
  writeFileSync(join(place, 'broken'), '');
  const failed = run('Known');
  assert.equal(failed.status, 3);
  assert.equal(failed.stderr, 'scanloom: tests failed; the lines above name them\n');
});

test('each sanitizer runs, also if the other one finds a fault', () => {
  const run = scanloomWith(
    { ...debian, cmake: '', ctest: 'echo "ctest $*"; case $* in *asan-core*) exit 8 ;; esac' },
    'test',
    '--sanitizers',
    '--core',
  );
  assert.equal(run.status, 3, run.stderr);
  const labels = [...run.stdout.matchAll(/^ctest --preset (\S+) .*--label-regex \^\((\S+)\)\$/gm)].map((match) =>
    match.slice(1),
  );
  assert.deepEqual(labels, [
    ['asan-core', 'http_test|maps_test|recovery_test|server_test'],
    ['tsan', 'server_test'],
  ]);
});

test('flakes lists failed tests and no skipped ones', () => {
  const ctest =
    'while [ "$1" != --output-log ]; do shift; done; printf "\\t 1 - a (Skipped)\\n\\t 2 - b (Failed)\\n" >"$2"; exit 8';
  const run = scanloomWith({ ...debian, cmake: '', ctest }, 'flakes', '--count', '2');
  assert.equal(run.status, 1, run.stderr);
  assert.match(run.stdout, /^failed, of 2 times:\n +2 test: b\n$/m);
  assert.doesNotMatch(run.stdout, /test: a/);
});
