/**
 * Positions on a page of 1280 x 800 that shows one tile of cells of 5 cm, its lower left corner at the origin: its 12.8
 * m fill the map's height except for 56 pixels on either side.
 */
export const kMiddle = [784, 400];

/** @returns [x, y] in pixels of the page, of a place in metres */
export function pixelOf(x, y) {
  const scale = (800 - 2 * 56) / 12.8;
  return [kMiddle[0] + (x - 6.4) * scale, kMiddle[1] - (y - 6.4) * scale].map(Math.round);
}
