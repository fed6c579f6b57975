/** The chosen session in the page's address, after '#': it survives a reload and can be sent to others. */

const kKey = 'session';

export function sessionOfHash(hash: string): string | null {
  return new URLSearchParams(hash.replace(/^#/, '')).get(kKey) || null;
}

export function hashOfSession(name: string): string {
  return `#${new URLSearchParams({ [kKey]: name })}`;
}
