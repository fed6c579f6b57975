/** Hands a file to the browser, as a click on a link to it does. */
import { el } from '../dom';

/** Long enough for any browser to have begun. */
const kKeepMs = 60_000;

export function saveBlob(blob: Blob, name: string): void {
  const address = URL.createObjectURL(blob);
  saveFrom(address, name);
  setTimeout(() => URL.revokeObjectURL(address), kKeepMs);
}

/** The browser fetches it by itself, however large it is. */
export function saveFrom(address: string, name: string): void {
  const link = el('a', { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
}
