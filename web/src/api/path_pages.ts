/** Long paths come in pages, each of which says up to which revision of the session it goes. */
import { MalformedAnswer } from './decode';

/**
 * The pages one after the other, each asked for as soon as the one before has been taken.
 *
 * @param since where they begin
 * @param wanted how far they are to go, asked after each; one that goes no further than it began is the last, too
 * @param fetchAfter the positions after a revision
 * @throws MalformedAnswer when the session does not go as far as it has gone; and what fetchAfter does
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
