/** Reports the accessibility violations that axe-core finds on the page. */
import axe from 'axe-core';

const kStandards = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'];

/** @returns one line for each violation: rule, description, elements */
export async function violations(page) {
  await page.evaluate(axe.source);
  const found = await page.evaluate(
    (tags) => window.axe.run(document, { runOnly: { type: 'tag', values: tags } }),
    kStandards,
  );
  return found.violations.map(({ id, help, nodes }) => {
    const where = nodes.map(({ target, any }) => `${target.join(' ')} ${any[0]?.message ?? ''}`);
    return `${id}: ${help}: ${where.join('; ')}`;
  });
}
