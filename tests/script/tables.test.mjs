// Tables of tests and documents that must agree with the sources.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { test } from 'node:test';

const source = resolve(import.meta.dirname ?? new URL('.', import.meta.url).pathname, '../..');

test('the files of each part of --all exist', () => {
  const text = readFileSync(join(source, 'tests/tiers.sh'), 'utf8');
  const table = text.match(/parts_of_all=\(\n([^]*?)\n\)/)[1];
  const files = [...table.matchAll(/^ *'.*;(.*)'$/gm)].flatMap((row) => row[1].split(' '));
  files.push(...text.match(/files_of_all_parts=\((.*)\)/)[1].split(' '));
  assert.ok(files.length > 15);
  for (const file of files) assert.ok(existsSync(join(source, file)), file);
});

test('test WORD and CONTRIBUTING.md know every test program', () => {
  const text = (name) => readFileSync(join(source, name), 'utf8');
  const made = [...text('tests/CMakeLists.txt').matchAll(/scanloom_test_program\((\w+)_test\b/g)].map(
    ([, name]) => name,
  );
  const known = [...text('tests/tiers.sh').matchAll(/of_tier\+?=\(([a-z ]+)\)/g)].flatMap(([, names]) =>
    names.split(' '),
  );
  assert.ok(made.length > 5);
  assert.deepEqual(known.sort(), made.sort());
  for (const name of made) assert.ok(text('CONTRIBUTING.md').includes(`\`${name}_test\``), name);
});

test('each setting that a document changes is reset by the next configuration', () => {
  const [base] = JSON.parse(readFileSync(join(source, 'CMakePresets.json'), 'utf8')).configurePresets;
  const texts = ['CONTRIBUTING.md', 'docs/internals/build.md', 'docs/internals/testing.md', 'web/CMakeLists.txt'];
  const text = texts.map((name) => readFileSync(join(source, name), 'utf8')).join();
  const changed = [...text.matchAll(/-D([A-Z_]+)=/g)].map((match) => match[1]);
  assert.ok(changed.length > 3);
  for (const name of changed) assert.ok(name in base.cacheVariables, name);
});

// The sources with a mutant, where "mutants" runs this, have no tests/mutants.
const sound = existsSync(join(source, 'tests/mutants'));

test('every mutant applies to the sources and is in the table of docs/internals/testing.md', { skip: !sound }, () => {
  const table = readFileSync(join(source, 'docs/internals/testing.md'), 'utf8').split('\n');
  for (const file of readdirSync(join(source, 'tests/mutants'))) {
    const options = ['--strip', '1', '--dry-run', '--forward', '--input', join('tests/mutants', file)];
    const run = spawnSync('patch', options, { cwd: source, encoding: 'utf8' });
    assert.equal(run.status, 0, `${file}: write it again\n${run.stdout}${run.stderr}${run.error ?? ''}`);
    const row = table.find((line) => line.startsWith(`| \`${file.replace('.patch', '')}\` |`));
    assert.ok(row, `${file} is not in the table`);
    const [, fault, word] = readFileSync(join(source, 'tests/mutants', file), 'utf8').match(/^(.*)\nTest: (.*)$/m);
    assert.ok(row.endsWith(`| ${fault} | \`${word}\` |`), `the table does not have the fault and the test of ${file}`);
  }
});

test('the tests that docs/internals/testing.md names for the removed ones exist', () => {
  const text = readFileSync(join(source, 'docs/internals/testing.md'), 'utf8');
  const rows = text.slice(text.indexOf('## Tests that were removed')).matchAll(/^\|.*\|(.*)\|$/gm);
  const named = [...rows].flatMap(([, found]) => [...found.matchAll(/`(\w+\.\w+)`/g)].map(([, name]) => name));
  assert.ok(named.length > 10);
  const tests = new Set();
  for (const file of readdirSync(join(source, 'tests'), { recursive: true })) {
    if (!/_test\.[ch]pp$/.test(file)) continue;
    const sources = readFileSync(join(source, 'tests', file), 'utf8');
    for (const [, suite, name] of sources.matchAll(/TEST\w*\(\s*(\w+),\s*(\w+)\s*\)/g)) tests.add(`${suite}.${name}`);
  }
  assert.deepEqual(
    named.filter((name) => !tests.has(name)),
    [],
  );
});
