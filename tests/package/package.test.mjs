// The output of ./scanloom package, for the build in SCANLOOM_BUILD_DIR: inspected, and run.
import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { createInterface } from 'node:readline';
import { after, before, test } from 'node:test';
import { librariesOf, ownersOf } from '../../packaging/sbom.mjs';
import { faultsOf, licenceOf, npmPackages } from '../../packaging/spdx.mjs';

const source = resolve(import.meta.dirname ?? new URL('.', import.meta.url).pathname, '../..');
const build = process.env.SCANLOOM_BUILD_DIR ?? join(source, 'build');
const has = (command) => spawnSync(command, ['--version']).error === undefined;
const missing = ['dpkg-deb', 'dpkg-shlibdeps', 'doxygen'].find((command) => !has(command));
const skip = missing ? `${missing} is not installed` : false;
const run = (command, ...args) => execFileSync(command, args, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });

let place, root, deb, listed;

before(() => {
  place = mkdtempSync(join(tmpdir(), 'scanloom-package-test.'));
  if (skip) return;
  const made = run(join(source, 'packaging/package.sh'), build, join(place, 'out')).trim().split('\n');
  deb = made[0];
  root = join(place, 'root');
  run('dpkg-deb', '--extract', deb, root);
  listed = JSON.parse(readFileSync(made[2], 'utf8'));
});
after(() => rmSync(place, { recursive: true, force: true }));

test('the package has the programs, the viewer, the service, its configuration, the documents and the API pages', {
  skip,
}, () => {
  for (const file of [
    'usr/bin/scanloom-server',
    'usr/bin/scanloom-robot',
    'usr/bin/scanloom-lab',
    'usr/bin/scanloom-load',
    'usr/share/scanloom/web/index.html',
    'usr/share/scanloom/ros/scanloom_bridge/package.xml',
    'usr/share/scanloom/ros/scanloom_bridge/scanloom_bridge/scanloom_client.py',
    'lib/systemd/system/scanloom-server.service',
    'usr/lib/sysusers.d/scanloom.conf',
    'etc/scanloom/scanloom-server.toml',
    'usr/share/doc/scanloom/docs/observability/alerts.yml',
    'usr/share/doc/scanloom/docs/security.md',
    'usr/share/doc/scanloom/scanloom.spdx.json',
    'usr/share/doc/scanloom/api/index.html',
    'usr/share/doc/scanloom/api/classscanloom_1_1robot_1_1Client.html',
  ]) {
    assert.ok(existsSync(join(root, file)), file);
  }
  const control = run('dpkg-deb', '--field', deb);
  for (const line of [
    /^Package: scanloom$/m,
    /^Version: \d/m,
    /^Depends: .*libssl3 \(>= 3/m,
    /^Depends: .*librocksdb7\.8/m,
  ])
    assert.match(control, line);
  assert.doesNotMatch(control, /@[A-Z]+@/);
  assert.match(run('dpkg-deb', '--contents', deb), /^-rwxr-xr-x root\/root .*usr\/bin\/scanloom-server$/m);
});

test('the archive has the same files', { skip }, () => {
  const archive = run('tar', '--list', '--gzip', '--file', deb.replace(/\.deb$/, '.tar.gz'))
    .split('\n')
    .filter((name) => !name.endsWith('/'));
  const files = readdirSync(root, { recursive: true })
    .map((name) => join(root, name))
    .filter((name) => statSync(name).isFile());
  assert.deepEqual(
    archive
      .filter(Boolean)
      .map((name) => join(root, name))
      .sort(),
    files.sort(),
  );
});

test('the same build and commit give the same bytes', { skip }, () => {
  const again = run(join(source, 'packaging/package.sh'), build, join(place, 'again')).trim().split('\n')[0];
  assert.ok(readFileSync(again).equals(readFileSync(deb)));
});

test('its component list is SPDX 2.3, and contains every library that ldd lists', { skip }, () => {
  assert.deepEqual(faultsOf(listed), []);
  const linked = new Set(
    listed.relationships.filter((one) => one.relationshipType === 'DYNAMIC_LINK').map((one) => one.relatedSpdxElement),
  );
  const names = new Set(listed.packages.filter((one) => linked.has(one.SPDXID)).map((one) => one.name));
  const programs = readdirSync(join(root, 'usr/bin')).map((name) => join(root, 'usr/bin', name));
  const needed = ownersOf([...new Set(programs.flatMap(librariesOf))]);
  assert.ok(needed.size > 20);
  for (const owner of needed) assert.ok(names.has(owner), owner);
});

test('the component list has the packages that the viewer bundles, and no build tools', { skip }, () => {
  const bundled = listed.packages.filter((one) => one.SPDXID.startsWith('SPDXRef-npm-')).map((one) => one.name);
  for (const name of Object.keys(JSON.parse(readFileSync(join(source, 'web/package.json'), 'utf8')).dependencies))
    assert.ok(bundled.includes(name), name);
  for (const tool of ['vite', 'typescript', 'esbuild']) assert.ok(!bundled.includes(tool), tool);
});

test('documents without required SPDX fields are detected', () => {
  const whole = {
    spdxVersion: 'SPDX-2.3',
    dataLicense: 'CC0-1.0',
    SPDXID: 'SPDXRef-DOCUMENT',
    name: 'a',
    documentNamespace: 'https://a/b',
    creationInfo: { created: '2026-01-01T00:00:00Z', creators: ['Tool: a'] },
    packages: [
      {
        SPDXID: 'SPDXRef-a',
        name: 'a',
        versionInfo: '1',
        downloadLocation: 'NOASSERTION',
        filesAnalyzed: false,
        licenseConcluded: 'NOASSERTION',
        licenseDeclared: 'MIT AND Zlib',
      },
    ],
    relationships: [
      { spdxElementId: 'SPDXRef-DOCUMENT', relationshipType: 'DESCRIBES', relatedSpdxElement: 'SPDXRef-a' },
    ],
  };
  assert.deepEqual(faultsOf(whole), []);
  for (const field of Object.keys(whole)) assert.notDeepEqual(faultsOf({ ...whole, [field]: undefined }), [], field);
  for (const [field, bad] of Object.entries({
    SPDXID: 'a b',
    name: '',
    versionInfo: '',
    downloadLocation: 'here',
    filesAnalyzed: true,
    licenseDeclared: 'do what you want',
  })) {
    assert.notDeepEqual(faultsOf({ ...whole, packages: [{ ...whole.packages[0], [field]: bad }] }), [], field);
  }
  assert.notDeepEqual(faultsOf({ ...whole, packages: [whole.packages[0], whole.packages[0]] }), [], 'twice');
});

test('licences are set where Debian has one for all files, and are never guessed', () => {
  const of = (licence) =>
    licenceOf(`Format: x\n\nFiles: debian/*\nLicense: GPL-2+\n\nFiles: *\nCopyright: a\nLicense: ${licence}\n text\n`);
  assert.equal(of('Expat'), 'MIT');
  assert.equal(of('GPL-2+ or Apache-2.0'), 'GPL-2.0-or-later OR Apache-2.0');
  for (const unclear of ['my-own', 'MIT and GPL-2 or Zlib', '']) assert.equal(of(unclear), 'NOASSERTION', unclear);
  assert.equal(licenceOf('You may use it.'), 'NOASSERTION');
});

test('npm packages that only the build needs are left out', () => {
  const lock = {
    packages: {
      '': {},
      'node_modules/a': { version: '1', license: '(MIT AND Zlib)' },
      'node_modules/a/node_modules/@b/c': { version: '2', license: 'see LICENSE' },
      'node_modules/d': { version: '3', dev: true },
    },
  };
  assert.deepEqual(
    npmPackages(lock).map((one) => [one.name, one.versionInfo, one.licenseDeclared]),
    [
      ['a', '1', 'MIT AND Zlib'],
      ['@b/c', '2', 'NOASSERTION'],
    ],
  );
});

test('the configuration and the secure compose file use only options of the server', () => {
  const known = new Set(
    [...run(join(build, 'bin/scanloom-server'), '--help').matchAll(/--[a-z-]+/g)].map((match) => match[0]),
  );
  const secure = readFileSync(join(source, 'docker/compose.secure.yaml'), 'utf8').match(
    / {4}entrypoint:[^]*?ports:/,
  )[0];
  const options = [...secure.matchAll(/--[a-z-]+/g)].map((match) => match[0]);
  const file = readFileSync(join(source, 'packaging/scanloom-server.toml'), 'utf8');
  const written = [...file.matchAll(/^(?:# )?([a-z-]+) = /gm)].map((match) => `--${match[1]}`);
  assert.ok(options.length > 8 && written.length > 8);
  for (const option of [...options, ...written]) assert.ok(known.has(option), option);
  assert.ok(!options.includes('--insecure'));
});

const noSystemd = skip || (has('systemd-analyze') ? false : 'systemd-analyze is not installed');

test('the service is valid for systemd, and hardened', { skip: noSystemd }, () => {
  // With the path of the extracted program, because systemd checks that it exists.
  const unit = join(place, 'scanloom-server.service');
  writeFileSync(
    unit,
    readFileSync(join(root, 'lib/systemd/system/scanloom-server.service'), 'utf8').replace(
      '/usr/bin/scanloom-server',
      join(root, 'usr/bin/scanloom-server'),
    ),
  );
  const verified = spawnSync('systemd-analyze', ['verify', '--recursive-errors=no', unit], { encoding: 'utf8' });
  assert.equal(
    verified.stderr
      .split('\n')
      .filter((line) => line.includes('scanloom-server.service'))
      .join('\n'),
    '',
  );
  const analysis = spawnSync('systemd-analyze', ['security', '--offline=true', '--no-pager', unit], {
    encoding: 'utf8',
  }).stdout;
  const exposure = Number(analysis.match(/Overall exposure level for scanloom-server\.service: ([\d.]+)/)?.[1]);
  assert.ok(exposure < 2.0, `its exposure is ${exposure}`);
});

test('the extracted server runs with the packaged configuration', { skip }, async () => {
  const server = spawn(
    join(root, 'usr/bin/scanloom-server'),
    [
      '--config',
      join(root, 'etc/scanloom/scanloom-server.toml'),
      '--store',
      join(place, 'store'),
      '--listen',
      '127.0.0.1:0',
      '--http',
      '127.0.0.1:0',
    ],
    { stdio: ['ignore', 'pipe', 'ignore'] },
  );
  const ended = new Promise((resolveEnd) => server.once('exit', resolveEnd));
  try {
    const lines = createInterface({ input: server.stdout })[Symbol.asyncIterator]();
    const ready = JSON.parse((await lines.next()).value);
    const page = await fetch(`http://127.0.0.1:${ready.http_port}/`);
    assert.equal(page.status, 200);
    assert.match(await page.text(), /<script type="module"/);
  } finally {
    server.kill('SIGTERM');
  }
  assert.equal(await ended, 0);
});
