import assert from 'node:assert/strict';
import { afterEach, describe, it, mock } from 'node:test';
import type { PastPoses } from '../../../../web/src/api/weaves';
import { ServerWeaver } from '../../../../web/src/time/weaver';

const kWeave = { id: 'f1', state: 'done', woven: 7, until: { revision: 7 }, exclusions: 3 };

describe('the requests of past maps', () => {
  afterEach(() => mock.restoreAll());

  /** Answers each request, and returns the bodies of those that start a replay job. */
  function serve(): unknown[] {
    const bodies: unknown[] = [];
    Object.assign(globalThis, { document: { baseURI: 'http://server/' } });
    mock.method(globalThis, 'fetch', async ({ pathname }: URL, { body }: RequestInit) => {
      if (typeof body === 'string') bodies.push(JSON.parse(body));
      return Response.json(pathname.endsWith('/changes') ? { revision: 7, tiles: [] } : kWeave);
    });
    return bodies;
  }

  function weaver(poses: () => PastPoses | null): ServerWeaver {
    return new ServerWeaver({ name: 's', id: '1' }, 0.05, poses, () => ['himm'], new AbortController().signal);
  }

  it('contain the chosen poses, and none if all robots send theirs', async () => {
    const bodies = serve();
    let poses: PastPoses | null = 'then';
    const past = weaver(() => poses);
    await past.start(7);
    poses = 'now';
    await past.start(8);
    await weaver(() => null).start(9);
    assert.deepEqual(bodies, [{ until: 7, poses: 'then' }, { until: 8, poses: 'now' }, { until: 9 }]);
  });

  it('make maps of one family only if their poses cannot differ', async () => {
    serve();
    const familyWith = async (poses: PastPoses | null, id: string): Promise<string> =>
      (await weaver(() => poses).load(id, () => {})).family;
    assert.equal(await familyWith(null, 'f1'), await familyWith(null, 'f2'));
    assert.notEqual(await familyWith('then', 'f1'), await familyWith('then', 'f2'));
    assert.notEqual(await familyWith('now', 'f1'), await familyWith('now', 'f2'));
  });
});
