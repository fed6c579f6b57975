/** Buttons with an icon instead of a text. */
import { el } from '../dom';

const kSvg = 'http://www.w3.org/2000/svg';

/**
 * @param key keyboard shortcut with the same effect
 * @param path of the icon in a square of 16
 */
export function iconButton(id: string, label: string, key: string, path: string): HTMLButtonElement {
  const sign = document.createElementNS(kSvg, 'svg');
  sign.setAttribute('viewBox', '0 0 16 16');
  sign.setAttribute('aria-hidden', 'true');
  sign.append(document.createElementNS(kSvg, 'path'));
  const button = el('button', { id, type: 'button', class: 'plain' }, sign);
  setIcon(button, label, key, path);
  return button;
}

/** Changes the button's icon and label. */
export function setIcon(button: HTMLButtonElement, label: string, key: string, path: string): void {
  if (button.getAttribute('aria-label') === label) return;
  button.setAttribute('aria-label', label);
  button.title = `${label} (${key})`;
  button.querySelector('path')?.setAttribute('d', path);
}
