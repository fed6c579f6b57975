// The pages of the C++ API, as packaging/api_pages.sh writes them.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { appendFileSync, cpSync, existsSync, mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, test } from 'node:test';

const source = resolve(import.meta.dirname ?? new URL('.', import.meta.url).pathname, '../..');
const skip = spawnSync('doxygen', ['--version']).error ? 'doxygen is not installed' : false;

let place, pages;

const writePages = (tree, output) =>
  spawnSync(join(tree, 'packaging/api_pages.sh'), ['1.2.3', output], { encoding: 'utf8' });
const page = (name) => readFileSync(join(pages, name), 'utf8');

before(() => {
  place = mkdtempSync(join(tmpdir(), 'scanloom-api-test.'));
  pages = join(place, 'pages');
});
after(() => rmSync(place, { recursive: true, force: true }));

test('doxygen has no warning about the public headers', { skip }, () => {
  const written = writePages(source, pages);
  assert.equal(written.stderr, '');
  assert.equal(written.status, 0);
});

test('the pages describe the client with parameters, results, errors, threads and sources', { skip }, () => {
  const client = page('classscanloom_1_1robot_1_1Client.html');
  for (const word of ['Parameters', 'Returns', 'Errors', 'Threads', 'Source', 'metres in the map frame', 'kNoPath'])
    assert.ok(client.includes(word), word);
  assert.match(page('client_8hpp.html'), /const auto robot = Client::start\(options\)\.value\(\);/);
});

test('there is a page of each namespace, and the main page has the version', { skip }, () => {
  assert.match(page('index.html'), /1\.2\.3/);
  for (const name of ['robot', 'link', 'limits', 'grid', 'mapping', 'classify', 'planning', 'landmarks'])
    assert.ok(existsSync(join(pages, `namespacescanloom_1_1${name}.html`)), name);
});

test('the pages contain no scripts', { skip }, () => {
  for (const name of readdirSync(pages)) {
    assert.doesNotMatch(name, /\.js$/);
    if (name.endsWith('.html')) assert.doesNotMatch(page(name), /<script/, name);
  }
});

test('a member without description, or with an incomplete one, is an error', { skip }, () => {
  const faults = [
    ['common/limits/semaphore.hpp', 'int permits_of(int count);', /permits_of.* is not documented/],
    ['core/grid/cell.hpp', '/// Counts.\n/// @param a  cells\nint count_of(int a, int b);', /parameter 'b'/],
    ['core/grid/outline.hpp', '/// Counts.\n/// @param c  cells\nint count_all(int a);', /argument 'c'/],
    ['robot_client/client/client.hpp', '/// Counts.\nint count_robots(int a);', /parameters of member .*count_robots/],
  ];
  for (const [index, [file, code, message]] of faults.entries()) {
    const tree = join(place, `fault_${index}`);
    for (const folder of ['common', 'core', 'docs/api', 'packaging', 'robot_client/client'])
      cpSync(join(source, folder), join(tree, folder), { recursive: true });
    appendFileSync(join(tree, file), `namespace scanloom::grid {\n${code}\n}\n`);
    const written = writePages(tree, join(tree, 'pages'));
    assert.notEqual(written.status, 0, file);
    assert.match(written.stderr, message);
  }
});
