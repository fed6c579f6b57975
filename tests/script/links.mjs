// Finds the links of Markdown documents that are broken.
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, relative, resolve } from 'node:path';

const withoutCode = (text) => text.replace(/^```[^]*?^```/gm, '').replace(/`[^`\n]*`/g, 'x');

/** Returns the targets of links and pictures, as written. */
const linksOf = (text) => [...withoutCode(text).matchAll(/\]\(([^)\s]+)\)/g)].map((match) => match[1]);

/** Returns the anchors of a document: its headings, in GitHub's spelling. */
function anchorsOf(text) {
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

/** Returns 'DOCUMENT: LINK' for each broken link in the documents of a folder. External links are not checked. */
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
