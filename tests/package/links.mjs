// The links of documents in Markdown, and which of them lead nowhere.
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, relative, resolve } from 'node:path';

const withoutCode = (text) => text.replace(/^```[^]*?^```/gm, '').replace(/`[^`\n]*`/g, 'x');

/** What is linked to or shown as a picture, as it is written. */
export const linksOf = (text) => [...withoutCode(text).matchAll(/\]\(([^)\s]+)\)/g)].map((match) => match[1]);

/** What a link within a document may name: its headings, in GitHub's spelling. */
export function anchorsOf(text) {
  const seen = new Map();
  return new Set(
    [...text.replace(/^```[^]*?^```/gm, '').matchAll(/^#+ (.*)$/gm)].map(([, heading]) => {
      const anchor = heading
        .toLowerCase()
        .replace(/[^\p{L}\p{N}\p{M}_ -]/gu, '')
        .replaceAll(' ', '-');
      const before = seen.get(anchor) ?? 0;
      seen.set(anchor, before + 1);
      return before === 0 ? anchor : `${anchor}-${before}`;
    }),
  );
}

/** 'DOCUMENT: LINK' of each link that leads nowhere, of all documents below a folder. What is elsewhere is not asked. */
export function deadLinks(folder) {
  const documents = readdirSync(folder, { recursive: true })
    .filter((name) => name.endsWith('.md'))
    .map((name) => join(folder, name));
  const leads = (from, link) => {
    const [path, anchor] = link.split('#');
    const target = path === '' ? from : resolve(dirname(from), decodeURIComponent(path));
    if (relative(folder, target).startsWith('..') || !existsSync(target)) return false;
    return !anchor || !target.endsWith('.md') || anchorsOf(readFileSync(target, 'utf8')).has(anchor);
  };
  return documents.flatMap((document) =>
    linksOf(readFileSync(document, 'utf8'))
      .filter((link) => !/^[a-z]+:/.test(link) && !leads(document, link))
      .map((link) => `${relative(folder, document)}: ${link}`),
  );
}
