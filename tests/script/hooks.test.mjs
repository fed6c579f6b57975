// The hooks of tests/hooks, in a repository of their own.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { copyFileSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { test } from 'node:test';

const source = resolve(import.meta.dirname ?? new URL('.', import.meta.url).pathname, '../..');

test('the hook refuses a commit outside a repository', () => {
  const env = { ...process.env, GIT_DIR: '/nonexistent' };
  const run = spawnSync(join(source, 'tests/hooks/pre-commit'), [], { env, encoding: 'utf8' });
  assert.notEqual(run.status, 0);
  assert.match(run.stderr, /not a git repository/);
});

test('the hook refuses a commit whose subject is not one', (t) => {
  const place = mkdtempSync(join(tmpdir(), 'scanloom-hook-test.'));
  t.after(() => rmSync(place, { recursive: true, force: true }));
  const check = (message) => {
    writeFileSync(join(place, 'message'), message);
    return spawnSync(join(source, 'tests/hooks/commit-msg'), [join(place, 'message')], { encoding: 'utf8' });
  };
  const longest = `store: ${'é'.repeat(65)}`;
  for (const good of [
    'store: keep 4 KiB blocks\n\nThis says why.',
    `# remark\n\n${longest}`,
    'README: name it',
    'Revert "store: a"',
    'fixup! a',
  ])
    assert.equal(check(good).status, 0, good);
  for (const bad of [`${longest}é`, 'keep 4 KiB blocks', 'store:keep', 'store: keep blocks.']) {
    const refused = check(bad);
    assert.equal(refused.status, 1, bad);
    assert.match(refused.stderr, /is no subject; write the part that changes/);
  }
});

test('the hook reports words that are not plain English, in comments and documents', (t) => {
  const copy = mkdtempSync(join(tmpdir(), 'scanloom-hook-test.'));
  t.after(() => rmSync(copy, { recursive: true, force: true }));
  mkdirSync(join(copy, 'tests/hooks'), { recursive: true });
  for (const name of ['words.sh', 'words.txt'])
    copyFileSync(join(source, 'tests/hooks', name), join(copy, 'tests/hooks', name));
  const git = (...words) => assert.equal(spawnSync('git', words, { cwd: copy }).status, 0, words.join(' '));
  const check = (name, text) => {
    writeFileSync(join(copy, name), text);
    git('add', name);
    return spawnSync('tests/hooks/words.sh', ['--cached'], { cwd: copy, encoding: 'utf8' });
  };
  git('init', '--quiet');
  assert.equal(check('a.cpp', '#include "woven.hpp"\n// Scans are integrated.\nint woven;\n').status, 0);
  const refused = check('a.cpp', '// Scans are woven.\n');
  assert.equal(refused.status, 1);
  assert.match(refused.stderr, /^a.cpp: "woven" \(better: integrated, or applied\): .*Scans are woven/);
  assert.equal(check('a.cpp', '').status, 0);
  for (const name of ['a.md', 'a.yaml']) {
    assert.equal(check(name, 'a session that is asleep\n').status, 1, name);
    assert.equal(check(name, '').status, 0, name);
  }
  assert.equal(check('a.py', '# A session that is asleep\n').status, 1);
  assert.equal(check('a.py', '').status, 0);
  assert.equal(check('a.mjs', "test('a session that is asleep');\n").status, 1);
});
