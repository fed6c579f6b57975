/** Reads long trajectories in pages; each page contains the session's revision that it reaches. */
import { MalformedAnswer } from './decode';

/**
 * Yields the pages one after the other; requests each after the caller has consumed the previous one.
 *
 * @param since revision after which the pages begin
 * @param wanted target revision, read after each page; a page that makes no progress also ends the sequence
 * @param fetchAfter fetches the positions after a revision
 * @throws MalformedAnswer when the session's revision decreased; and the errors of fetchAfter
 */
export async function* pagesOf<Page extends { revision: number }>(
  since: number,
  wanted: () => number,
  fetchAfter: (revision: number) => Promise<Page>,
): AsyncGenerator<Page, void, undefined> {
  for (let from = since; ; ) {
    const page = await fetchAfter(from);
    if (page.revision < from) throw new MalformedAnswer(`paths after revision ${from} end at ${page.revision}`);
    yield page;
    if (page.revision === from || page.revision >= wanted()) return;
    from = page.revision;
  }
}
