/** The part of the map that no control covers: content is fitted into this part. */

/** Edges in pixels from the map's top left corner. */
export interface Box {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

/** Padding in pixels for each side, in the order of OpenLayers. */
export type Padding = [top: number, right: number, bottom: number, left: number];

/** Distance between a control and fitted content: a robot at the edge of the map is drawn this far beyond it. */
const kGapPx = 14;

/**
 * For each control, keeps free the side next to it or the part above or below it, so that the content becomes as large
 * as possible.
 *
 * @param size     of the map, pixels
 * @param aspect   width of the content by its height
 * @param margin   pixels to leave free at each side in any case
 * @param controls boxes that cover the map
 */
export function freePadding(size: [number, number], aspect: number, margin: number, controls: Box[]): Padding {
  let choices: Padding[] = [[margin, margin, margin, margin]];
  for (const box of controls) choices = choices.flatMap((padding) => clear(size, padding, box));
  const width = (padding: Padding): number => contentWidth(size, aspect, padding);
  return choices.reduce((best, each) => (width(each) > width(best) ? each : best));
}

/** The paddings that keep the control off the content: the unchanged one if it is off already. */
function clear([width, height]: [number, number], padding: Padding, box: Box): Padding[] {
  const [top, right, bottom, left] = padding;
  const isClear = box.right <= left || box.left >= width - right || box.bottom <= top || box.top >= height - bottom;
  if (isClear) return [padding];
  const isLeft = box.left + box.right < width;
  const isAbove = box.top + box.bottom < height;
  return [
    isLeft ? [top, right, bottom, box.right + kGapPx] : [top, width - box.left + kGapPx, bottom, left],
    isAbove ? [box.bottom + kGapPx, right, bottom, left] : [top, right, height - box.top + kGapPx, left],
  ];
}

/** Width of the fitted content, pixels. */
function contentWidth([width, height]: [number, number], aspect: number, [top, right, bottom, left]: Padding): number {
  return Math.min(width - left - right, (height - top - bottom) * aspect);
}
