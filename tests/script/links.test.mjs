// The links of the documents.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, test } from 'node:test';
import { deadLinks } from './links.mjs';

const source = resolve(import.meta.dirname ?? new URL('.', import.meta.url).pathname, '../..');
const place = mkdtempSync(join(tmpdir(), 'scanloom-links-test.'));
after(() => rmSync(place, { recursive: true, force: true }));

test('every link of the packaged documents has a target among the packaged files', () => {
  const documents = join(place, 'package');
  mkdirSync(documents);
  execFileSync(join(source, 'packaging/documents.sh'), [documents]);
  assert.ok(existsSync(join(documents, 'docs/observability/alerts.yml')));
  assert.deepEqual(deadLinks(documents), []);
});

test('broken links are detected', () => {
  const folder = join(place, 'documents');
  mkdirSync(join(folder, 'more'), { recursive: true });
  const write = (name, text) => writeFileSync(join(folder, name), text);
  write(
    'a.md',
    '# The first: `one`, and more\n\n```sh\n# none [x](gone)\n```\n## Twice\n## Twice\n[b](more/b.md), [elsewhere](https://example.org/x), `[code](gone)`',
  );
  write('more/b.md', '[up](../a.md), ![it](../a.md#the-first-one-and-more) [2](../a.md#twice-1)');
  assert.deepEqual(deadLinks(folder), []);
  write(
    'more/b.md',
    '[here](#none), [there](../a.md#none), [gone](c.md), [out](../../package.json), [3](../a.md#twice-2)',
  );
  writeFileSync(join(place, 'package.json'), '');
  assert.deepEqual(
    deadLinks(folder),
    ['#none', '../a.md#none', 'c.md', '../../package.json', '../a.md#twice-2'].map((link) => `more/b.md: ${link}`),
  );
});
