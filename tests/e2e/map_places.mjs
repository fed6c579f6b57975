/** Converts metres on the map to pixels on the page, from the readout under the pointer. */
import { textOf } from './browser.mjs';

const kTop = [420, 300];
const kBottom = [760, 640];

/** @returns a function from [x, y] in metres to [x, y] in pixels, valid until the map is moved */
export async function pixelsOf(page) {
  const [low, high] = [await placeAt(page, kTop), await placeAt(page, kBottom)];
  const along = (axis, metres) =>
    kTop[axis] + ((metres - low[axis]) / (high[axis] - low[axis])) * (kBottom[axis] - kTop[axis]);
  return ([x, y]) => [along(0, x), along(1, y)];
}

async function placeAt(page, pixel) {
  await page.mouse.move(...pixel);
  const before = await read(page);
  await page.mouse.move(pixel[0] + 1, pixel[1]);
  await page.mouse.move(...pixel);
  await page.waitForFunction(() => document.querySelector('#cursor-x').textContent !== '');
  return (await read(page)) ?? before;
}

async function read(page) {
  const texts = await Promise.all(['#cursor-x', '#cursor-y'].map((field) => textOf(page, field)));
  return texts.map((text) => Number(text.replace('\u2212', '-')));
}
