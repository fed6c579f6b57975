import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { MalformedAnswer } from '../../../../web/src/api/decode';
import { pagesOf } from '../../../../web/src/api/path_pages';

/** What is asked of a session that long, in pages of `atOnce` revisions. */
async function asked(since: number, wanted: () => number, revision: number, atOnce: number): Promise<number[]> {
  const all: number[] = [];
  const pages = pagesOf(since, wanted, (from) => {
    assert.ok(all.push(from) < 20, 'it comes to an end');
    return Promise.resolve({ revision: Math.min(revision, from + atOnce) });
  });
  let until = since;
  for await (const page of pages) {
    assert.ok(page.revision >= until);
    until = page.revision;
  }
  return all;
}

describe('pages of paths', () => {
  it('are one where one is enough, also of a session without any', async () => {
    assert.deepEqual(await asked(0, () => 10, 10, 100), [0]);
    assert.deepEqual(await asked(0, () => 0, 0, 100), [0]);
  });

  it('go on from where the one before ended until what is wanted is reached', async () => {
    assert.deepEqual(await asked(0, () => 10, 10, 3), [0, 3, 6, 9]);
    assert.deepEqual(await asked(4, () => 9, 99, 3), [4, 7]);
  });

  it('go further when more is wanted meanwhile', async () => {
    let wanted = 2;
    assert.deepEqual(await asked(0, () => (wanted += 2), 99, 3), [0, 3]);
  });

  it('end where one goes no further than it began, whatever was wanted', async () => {
    assert.deepEqual(await asked(0, () => 99, 10, 5), [0, 5, 10]);
  });

  it('are not those of a session that is shorter than it was', async () => {
    await assert.rejects(
      asked(7, () => 9, 5, 3),
      MalformedAnswer,
    );
  });
});
