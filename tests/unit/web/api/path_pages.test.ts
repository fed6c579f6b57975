import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { MalformedAnswer } from '../../../../web/src/api/decode';
import { pagesOf } from '../../../../web/src/api/path_pages';

/** Returns the requests for a session of `revision`, with pages of `atOnce` revisions. */
async function requests(since: number, wanted: () => number, revision: number, atOnce: number): Promise<number[]> {
  const all: number[] = [];
  const pages = pagesOf(since, wanted, (from) => {
    assert.ok(all.push(from) < 20, 'the requests must end');
    return Promise.resolve({ revision: Math.min(revision, from + atOnce) });
  });
  let until = since;
  for await (const page of pages) {
    assert.ok(page.revision >= until);
    until = page.revision;
  }
  return all;
}

describe('path pages', () => {
  it('are one request if one suffices, also for an empty session', async () => {
    assert.deepEqual(await requests(0, () => 10, 10, 100), [0]);
    assert.deepEqual(await requests(0, () => 0, 0, 100), [0]);
  });

  it('continue after the previous page until the wanted revision', async () => {
    assert.deepEqual(await requests(0, () => 10, 10, 3), [0, 3, 6, 9]);
    assert.deepEqual(await requests(4, () => 9, 99, 3), [4, 7]);
  });

  it('continue when the wanted revision increases meanwhile', async () => {
    let wanted = 2;
    assert.deepEqual(await requests(0, () => (wanted += 2), 99, 3), [0, 3]);
  });

  it('end when a page makes no progress', async () => {
    assert.deepEqual(await requests(0, () => 99, 10, 5), [0, 5, 10]);
  });

  it('refuse a revision that decreases', async () => {
    await assert.rejects(
      requests(7, () => 9, 5, 3),
      MalformedAnswer,
    );
  });
});
