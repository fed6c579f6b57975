// The output of ./scanloom itself.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import {
  chmodSync,
  copyFileSync,
  existsSync,
  mkdirSync,
  readFileSync,
  rmSync,
  symlinkSync,
  writeFileSync,
} from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { debian, place, scanloom, scanloomWith, source, withPrograms } from './script_copy.mjs';

const commandsIn = (text) => [...text.matchAll(/^ {2}([a-z]+) /gm)].map((match) => match[1]);

test('--help of every command prints its part of the usage only', () => {
  const usage = scanloom('help').stdout;
  const commands = commandsIn(usage).filter((command) => command !== 'help');
  assert.ok(commands.length > 10);
  for (const command of commands) {
    for (const words of [['--help'], ['-h'], ['--seed', '1', '--help']]) {
      const result = scanloom(command, ...words);
      assert.equal(result.status, 0, `${command}: ${result.stderr}`);
      assert.deepEqual(commandsIn(result.stdout), [command]);
      assert.equal(scanloom('help', command).stdout, result.stdout);
      assert.ok(usage.includes(result.stdout.split('\n').slice(2).join('\n')));
    }
  }
  assert.match(scanloom('fault', '--help').stdout, /--count N {8}number of repetitions/);
});

test('the usage has every command that the script knows', () => {
  const known = readFileSync(join(source, 'scanloom'), 'utf8')
    .match(/^ {8}(build \|.*)\) ;;$/m)[1]
    .split(' | ');
  assert.deepEqual(commandsIn(scanloom('help').stdout).sort(), [...known, 'help'].sort());
});

test('an unknown command is refused, with and without --help', () => {
  for (const words of [['paint'], ['paint', '--help'], ['help', 'paint']]) {
    const result = scanloom(...words);
    assert.equal(result.status, 2);
    assert.match(result.stderr, /there is no command 'paint'/);
  }
});

test('a build that fails for an external reason reports it', () => {
  const disk = scanloomWith({ ...debian, cmake: 'echo "write: No space left on device"; exit 1' }, 'demo');
  assert.equal(disk.status, 1);
  assert.match(disk.stdout, /^This builds the server, the robot and the viewer, .*\n\.\.\. {3}configure \(release\)\n/);
  assert.match(
    disk.stderr,
    /^scanloom: configure \(release\) failed: a disk is full \(that of .*\/build has \d+ MB left\); free space/m,
  );
  const network = scanloomWith({ ...debian, cmake: 'echo "npm error code EAI_AGAIN"; exit 1' }, 'demo');
  assert.match(network.stderr, /failed: packages were not downloaded; the network must reach/);
  const installing = (answer) =>
    scanloomWith(
      { 'dpkg-query': '', sudo: '[ "$1" = --validate ] || exec "$@"', 'apt-get': `echo "E: ${answer}"; exit 100` },
      'demo',
    ).stderr;
  assert.match(
    installing('Failed to fetch http://deb.example.org/x.deb  Temporary failure resolving'),
    /install \d+ Debian packages failed: packages were not downloaded; the network must reach/,
  );
  assert.match(
    installing('Could not get lock /var/lib/dpkg/lock-frontend. It is held by process 7'),
    /install \d+ Debian packages failed: another program installs packages; repeat the command when it has ended/,
  );
  const offline = 'Temporary failure resolving deb.example.org';
  assert.match(
    installing(`Unable to locate package cmake"; echo "W: Failed to fetch http://deb.example.org ${offline}`),
    /install \d+ Debian packages failed: packages were not downloaded; the network must reach/,
  );
  assert.match(
    installing('Unable to locate package libboost1.81-dev'),
    /install \d+ Debian packages failed: the package sources of this system lack packages of Debian 12 /,
  );
  const sources = scanloomWith({ ...debian, cmake: 'echo "a.cpp:3: error"; exit 1' }, 'demo');
  assert.equal(sources.stderr, 'scanloom: configure (release) failed\n');
});

test('unknown arguments are refused before anything is built', () => {
  for (const [words, sentence] of [
    [['test', 'two words'], /test takes one word .*, not 'two words'/],
    [['test', 'a', 'b'], /test takes one word .*, not 'a b'/],
    [['test', '--nightly', 'a', 'b'], /test takes one word .*, not 'a b'/],
    [['test', 'a', '--all', 'b'], /test takes one word .*, not 'a b'/],
    [['test', 'a', '--alll'], /test takes no '--alll'/],
    [['test', '.'], /test takes one word .*, not '\.'/],
    [['test', '--changed'], /test --changed takes a commit of the git clone it runs in, not ''/],
    [['test', '--changed', 'nonsense'], /test --changed takes a commit of the git clone it runs in, not 'nonsense'/],
    [['test', '--sanitizers', 'a'], /test --sanitizers takes no 'a'/],
    [['flakes', '--count', 'x'], /--count is 'x'; a whole number of at most 9 digits is needed/],
    [['flakes', '--count', '0'], /at least 1 is needed/],
    [['mutants', 'nonsense'], /tests\/mutants has no mutant 'nonsense'/],
    [['mutants', '*'], /tests\/mutants has no mutant '\*'/],
    [['mutants', ''], /tests\/mutants has no mutant ''/],
    [['fmt', '--chekc'], /fmt takes no '--chekc'/],
    [['tidy', 'no_such.cpp'], /the file 'no_such.cpp' cannot be read/],
    [['install', 'nonsense'], /packages.txt has no section 'nonsense'/],
    [['build', '--robot', 'x'], /build --robot takes no 'x'/],
    [['bench', 'projection', 'x'], /bench projection takes no 'x'/],
    [['fuzz', 'nonsense'], /there is no fuzzer 'nonsense', only /],
    [['fuzz', '..'], /there is no fuzzer '..', only /],
    [['fuzz', ''], /fuzz takes no ''/],
    [['fuzz', '--seconds', '0'], /--seconds is 0; at least 1 is needed/],
    [['demo', '--http-port', '99999'], /--http-port is 99999; ports go up to 65535/],
    [['demo', '--for', 'ever'], /--for is 'ever'; a whole number/],
    [['demo', '--log', 'no_such.log'], /the file 'no_such.log' cannot be read/],
    [['bench', 'nonsense'], /no part of the benchmarks and no benchmark matches 'nonsense'/],
    [['bench', 'robot'], /the file '' cannot be read/],
    [['bench', 'tiles', ''], /the file '' cannot be read/],
    [['fault', '--foo'], /fault takes \[ROW\] .*, not '--foo'/],
    [['fault', ''], /fault takes \[ROW\] .*, not ''/],
    [['fault', 'nonsense'], /there is no row 'nonsense' /],
    [['fault', 'kill', 'link'], /fault takes \[ROW\] .*, not 'kill link'/],
    [['fault', 'kill', '--count'], /fault takes \[ROW\] .*, not 'kill --count'/],
    [['fuzz', 'a', 'b'], /fuzz takes one target, not also 'b'/],
    [['mutants', 'a', 'b'], /mutants takes one name, not 'a b'/],
    [['pictures', 'a', 'b', 'c', 'd'], /pictures needs a log: /],
  ]) {
    const result = scanloomWith(debian, ...words);
    assert.equal(result.status, 2, words.join(' '));
    assert.match(result.stderr, sentence);
  }
});

test('known arguments are accepted', () => {
  const failing = { ...debian, cmake: 'exit 1' };
  for (const words of [
    ['bench', 'Insert'],
    ['bench', 'Tile.*/1024$'], // may be a name
    ['fault', 'kill', '--seed', '7', '--count', '1', '--long'],
    ['fault', 'all'],
  ]) {
    const result = scanloomWith(failing, ...words);
    assert.match(result.stderr, /^scanloom: configure \(.*\) failed\n$/, words.join(' '));
  }
});

test('it runs from any folder, by sh, with a CDPATH, and files are relative to that folder', () => {
  const elsewhere = join(place, 'else where');
  mkdirSync(elsewhere);
  mkdirSync(join(elsewhere, 'copy'));
  writeFileSync(join(elsewhere, 'a.log'), '');
  const env = { ...process.env, CDPATH: `.:${elsewhere}` };
  const run = (...words) => spawnSync('sh', ['../scanloom', ...words], { cwd: elsewhere, encoding: 'utf8', env });
  assert.equal(run('help').stdout, scanloom('help').stdout);
  assert.match(run('pictures', 'b.log').stderr, /the file 'b.log' cannot be read/);
  assert.match(run('demo', '--log', 'a.log', '--for', 'ever').stderr, /--for is 'ever'/);
});

test('a second build waits until the first has ended', async () => {
  const [order, go] = [join(place, 'order'), join(place, 'go')];
  const one = `if [ -e ${order} ] && [ ! -e ${go} ]; then exit 1; fi`;
  const program = `${one}; echo "$$" >>${order}; while [ ! -e ${go} ]; do sleep 0.01; done; echo "$$" >>${order}`;
  const env = withPrograms({ ...debian, cmake: program });
  const first = spawn(join(place, 'scanloom'), ['build'], { stdio: 'ignore', env });
  const firstEnded = once(first, 'exit');
  while (!existsSync(order)) await setTimeout(20);
  const second = spawn(join(place, 'scanloom'), ['build'], { env });
  const secondEnded = once(second, 'exit');
  let output = '';
  for await (const text of second.stdout) {
    output += text;
    if (output.includes('another ./scanloom is building here; waiting for it')) writeFileSync(go, '');
  }
  const waited = existsSync(go);
  writeFileSync(go, '');
  const [[firstCode], [secondCode]] = [await firstEnded, await secondEnded];
  assert.deepEqual({ waited, firstCode, secondCode }, { waited: true, firstCode: 0, secondCode: 0 }, output);
  const ids = readFileSync(order, 'utf8').trim().split('\n');
  for (let i = 0; i < ids.length; i += 2) assert.equal(ids[i], ids[i + 1]);
});

test('a folder that cannot be written is reported', () => {
  const copy = join(place, 'unwritable');
  mkdirSync(copy);
  for (const name of ['scanloom', 'packages.txt']) copyFileSync(join(source, name), join(copy, name));
  writeFileSync(join(copy, 'build'), '');
  const env = withPrograms({ ...debian, cmake: '' });
  const result = spawnSync(join(copy, 'scanloom'), ['build'], { encoding: 'utf8', env });
  assert.equal(result.status, 1);
  assert.match(result.stderr, /^scanloom: the folder .*\/build\/log cannot be created or written; make .* writable/m);
});

test('a demo whose ports are taken gets others, and keeps its logs if it fails', () => {
  const bin = join(place, 'build/bin');
  mkdirSync(bin, { recursive: true });
  const program = (name, ...lines) =>
    writeFileSync(join(bin, name), ['#!/bin/sh', ...lines].join('\n'), { mode: 0o755 });
  const demo = () =>
    spawnSync(join(place, 'scanloom'), ['demo', '--for', '1'], {
      encoding: 'utf8',
      env: { ...withPrograms({ ...debian, cmake: '' }), TMPDIR: place },
    });
  program('scanloom-robot', `echo '{"scans":9,"acknowledged":7}'`, 'exec sleep 60');
  program(
    'scanloom-server',
    'case "$2 $4" in *:7447*|*:8080*) echo "a port is taken" >&2; exit 1 ;; esac',
    `echo '{"event":"ready","robot_port":5001,"http_port":5002}'`,
    'exec sleep 60',
  );
  const result = demo();
  assert.equal(result.status, 0, result.stderr);
  assert.match(result.stdout, /http:\/\/127.0.0.1:5002\/\n.*127.0.0.1:5001\.[^]* 7 scans were stored/);
  program('scanloom-server', 'echo "no store" >&2', 'exit 1');
  const failed = demo();
  assert.equal(failed.status, 1);
  const [, log] = failed.stderr.match(/^FAILED the server did not start; the end of (.*):\nno store\n$/);
  assert.equal(readFileSync(log, 'utf8'), 'no store\n');
});

test('tidy lists the files that clang-tidy does not check', () => {
  mkdirSync(join(place, 'tests/e2e/node_modules/.bin'), { recursive: true });
  writeFileSync(join(place, 'tests/e2e/package-lock.json'), '');
  writeFileSync(join(place, 'tests/e2e/node_modules/.package-lock.json'), '');
  writeFileSync(join(place, 'tests/x.cpp'), '');
  const result = scanloomWith({ ...debian, npm: '' }, 'tidy', join(place, 'tests/x.cpp'));
  assert.equal(result.status, 0, result.stderr);
  assert.match(result.stdout, /^not checked: tests\/x.cpp \(clang-tidy reads only the folders common core /m);
});

test('fmt reads new files and no deleted ones', () => {
  for (const name of ['kept.cpp', 'deleted.cpp']) writeFileSync(join(place, name), '');
  for (const words of [
    ['init', '--quiet'],
    ['add', 'kept.cpp', 'deleted.cpp'],
  ])
    spawnSync('git', words, { cwd: place });
  rmSync(join(place, 'deleted.cpp'));
  writeFileSync(join(place, 'new.cpp'), '');
  const result = scanloomWith({ ...debian, npm: '', 'clang-format-14': 'echo "$@"' }, 'fmt');
  assert.equal(result.status, 0, result.stderr);
  assert.deepEqual(result.stdout.match(/\b(kept|deleted|new)\.cpp/g).sort(), ['kept.cpp', 'new.cpp']);
});

test('a message reports a system that is not Debian', () => {
  const bin = join(place, 'no_debian');
  mkdirSync(bin);
  for (const name of ['bash', 'env', 'dirname']) symlinkSync(`/usr/bin/${name}`, join(bin, name));
  const result = spawnSync(join(place, 'scanloom'), ['demo'], { encoding: 'utf8', env: { ...process.env, PATH: bin } });
  assert.equal(result.status, 1);
  assert.equal(
    result.stderr,
    'scanloom: this is not Debian; packages.txt lists the Debian 12 packages that Scanloom needs\n',
  );
});

test('without root or sudo, the message has the command for root', () => {
  chmodSync(place, 0o755);
  const env = withPrograms({ 'dpkg-query': '', sudo: 'exit 1' });
  const uid = process.getuid() || 65534;
  const result = spawnSync(join(place, 'scanloom'), ['install', 'fmt'], { encoding: 'utf8', env, uid });
  assert.equal(result.status, 1);
  assert.match(
    result.stderr,
    /^scanloom: Debian packages are missing, and installation needs root or sudo; run as root: apt-get install clang-format-14\b/,
  );
});

test('fault lists the rows of an existing program', () => {
  mkdirSync(join(place, 'build/tests'), { recursive: true });
  const program = join(place, 'build/tests/scanloom-fault');
  writeFileSync(program, '#!/bin/sh\necho "  kill     one row, $# words"\n');
  chmodSync(program, 0o755);
  const result = scanloom('fault');
  assert.equal(result.status, 0, result.stderr);
  assert.match(result.stdout, /^ {2}kill {5}one row, 0 words\n {2}fuzz /);
  assert.notEqual(
    scanloomWith(debian, 'fault', 'kill').status,
    0,
    'a row is that of the sources, which are built first',
  );
});
