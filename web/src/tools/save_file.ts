/** Saves a file by a click on a download link. */
import { el } from '../dom';

/** Every browser has started the download by then. */
const kKeepMs = 60_000;

export function saveBlob(blob: Blob, name: string): void {
  const address = URL.createObjectURL(blob);
  saveFrom(address, name);
  setTimeout(() => URL.revokeObjectURL(address), kKeepMs);
}

/** The browser downloads the file itself, whatever its size. */
export function saveFrom(address: string, name: string): void {
  const link = el('a', { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
}
