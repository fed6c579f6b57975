import assert from 'node:assert/strict';
import { afterEach, beforeEach, describe, it, mock } from 'node:test';
import { MalformedAnswer } from '../../../../web/src/api/decode';
import { Refused } from '../../../../web/src/api/http';
import { decodePathPage, fetchPathFile, PathFile } from '../../../../web/src/api/path_file';

/** Positions of each robot, by revision. */
type Course = Record<string, [revision: number, x: number, y: number][]>;

const kCourse: Course = {
  a: [
    [1, 0.5, -1.25],
    [3, 2, 0],
    [4, 1e-3, 7],
    [9, 3, 3],
  ],
  late: [[8, -4, 0.125]],
  still: [],
};

/** Returns a page in the format of the server. */
function answer(course: Course, since: number, until: number, corrected = 0): string {
  const features = Object.entries(course).map(([robot, positions]) => {
    const page = positions.filter(([revision]) => revision > since && revision <= until);
    const points = page.map(([, x, y]) => `[${x},${y}]`).join(',');
    const type = page.length < 2 ? 'MultiPoint' : 'LineString';
    const properties = `"properties":{"robot":"${robot}","points":${page.length}}`;
    return `{"type":"Feature","id":"${robot}",${properties},"geometry":{"type":"${type}","coordinates":[${points}]}}`;
  });
  const revisions = `"revision":${until},"poses_corrected":${corrected}`;
  const head = `"type":"FeatureCollection","frame_id":"map","units":"m",${revisions}`;
  return `{${head},"features":[${features.join(',')}]}`;
}

describe('a file of paths', () => {
  it('equals one answer when it has several pages', async () => {
    for (const pages of [[9], [2, 9], [3, 4, 7, 9], [1, 2, 3, 4, 5, 6, 7, 8, 9]]) {
      const file = new PathFile();
      let since = 0;
      for (const until of pages) {
        file.add(decodePathPage(answer(kCourse, since, until)));
        since = until;
      }
      assert.equal(await file.blob().text(), answer(kCourse, 0, 9), `pages up to ${pages.join()}`);
      assert.equal(file.blob().type, 'application/geo+json');
    }
  });

  it('contains robots of later pages, and may contain no robot', async () => {
    const file = new PathFile();
    const { late, ...before } = kCourse;
    file.add(decodePathPage(answer(before, 0, 4)));
    file.add(decodePathPage(answer({ ...before, late: late ?? [] }, 4, 9)));
    const { features } = JSON.parse(await file.blob().text());
    type Feature = { id: string; properties: { points: number } };
    const counts = features.map(({ id, properties }: Feature) => [id, properties.points]);
    assert.deepEqual(counts, [
      ['a', 4],
      ['still', 0],
      ['late', 1],
    ]);
    const empty = new PathFile();
    empty.add(decodePathPage(answer({}, 0, 0)));
    assert.equal(await empty.blob().text(), answer({}, 0, 0));
  });

  it('refuses pages between which poses were corrected', () => {
    const file = new PathFile();
    file.add(decodePathPage(answer(kCourse, 0, 4)));
    assert.throws(() => file.add(decodePathPage(answer(kCourse, 4, 9, 7))), /poses were corrected meanwhile/);
  });

  it('refuses invalid pages', () => {
    assert.throws(() => decodePathPage('{"type":'), MalformedAnswer);
    assert.throws(() => decodePathPage('{"frame_id":"map","units":"m","features":[]}'), /revision is not a number/);
  });
});

describe('fetching a file of paths', () => {
  let requests: string[];
  let refuse: string | null;
  let refusal: number;
  /** Session ids of the next answers; afterwards the id is 1. */
  let ids: string[];

  /** Serves a session of revision 9, with four revisions per page. */
  function serve(url: URL): Response {
    requests.push(url.pathname + url.search);
    if (url.search === refuse) return new Response('{"title":"busy"}', { status: refusal });
    if (url.pathname.endsWith('trajectory.geojson')) {
      const since = Number(url.searchParams.get('since'));
      return new Response(answer(kCourse, since, Math.min(9, since + 4)));
    }
    const config = { cell_size: 0.05 };
    const id = ids.shift() ?? '1';
    return Response.json({
      name: 's',
      id,
      created: '',
      number: 1,
      revision: 9,
      scans: 5,
      config,
      bounds: null,
      mainBounds: null,
      robots: [],
    });
  }

  beforeEach(() => {
    requests = [];
    refuse = null;
    refusal = 503;
    ids = [];
    Object.assign(globalThis, { document: { baseURI: 'http://localhost/' } });
    mock.method(globalThis, 'fetch', (url: URL) => Promise.resolve(serve(url)));
  });

  afterEach(() => mock.restoreAll());

  it('requests pages until the end and reports the bytes of all pages', async () => {
    const progress: number[] = [];
    const file = await fetchPathFile('s', new AbortController().signal, (bytes) => progress.push(bytes));
    const path = '/api/v1/sessions/s/trajectory.geojson';
    const session = '/api/v1/sessions/s';
    assert.deepEqual(requests, [session, path, `${path}?since=4`, `${path}?since=8`, session]);
    assert.equal(await file.text(), answer(kCourse, 0, 9));
    assert.deepEqual(
      progress,
      [...progress].sort((a, b) => a - b),
    );
    const bytes = [
      [0, 4],
      [4, 8],
      [8, 9],
    ].map(([since = 0, until = 0]) => answer(kCourse, since, until).length);
    assert.equal(
      progress.at(-1),
      bytes.reduce((sum, each) => sum + each, 0),
    );
  });

  it('retries a page that is temporarily refused', async () => {
    refuse = '?since=4';
    const pauses: number[] = [];
    const file = await fetchPathFile(
      's',
      new AbortController().signal,
      () => {},
      (failures) => {
        if (pauses.push(failures) === 3) refuse = null;
        return Promise.resolve();
      },
    );
    assert.equal(await file.text(), answer(kCourse, 0, 9));
    assert.deepEqual(pauses, [1, 2, 3]);
  });

  it('fails as a whole when a page fails', async () => {
    refuse = '?since=4';
    const pauses: number[] = [];
    const pause = (failures: number): Promise<void> => Promise.resolve(void pauses.push(failures));
    await assert.rejects(
      fetchPathFile('s', new AbortController().signal, () => {}, pause),
      Refused,
    );
    assert.deepEqual(pauses, [1, 2, 3, 4, 5, 6, 7, 8]);
    refusal = 500;
    await assert.rejects(
      fetchPathFile('s', new AbortController().signal, () => {}, pause),
      Refused,
    );
    assert.equal(pauses.length, 8, 'retrying must not help');
  });

  it('fails when the session is replaced', async () => {
    ids.push('1', '2');
    await assert.rejects(
      fetchPathFile('s', new AbortController().signal, () => {}),
      /replaced meanwhile/,
    );
  });
});
