/** The part of the map that no control lies on: what is fitted into the view is fitted into this part. */

/** Edges in pixels from the map's top left corner. */
export interface Box {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

/** Pixels to leave free at each side, in the order of OpenLayers' padding. */
export type Padding = [top: number, right: number, bottom: number, left: number];

/** Between a control and what is fitted: a robot at the edge of the map is drawn this far beyond it. */
const kGapPx = 14;

/**
 * Chooses for each control whether to leave free the side that it is at or the part above or below it, so that the
 * content becomes as large as possible.
 *
 * @param size     of the map, pixels
 * @param aspect   width of the content by its height
 * @param margin   pixels to leave free at each side in any case
 * @param controls what lies on the map
 */
export function freePadding(size: [number, number], aspect: number, margin: number, controls: Box[]): Padding {
  let choices: Padding[] = [[margin, margin, margin, margin]];
  for (const box of controls) choices = choices.flatMap((padding) => clear(size, padding, box));
  const width = (padding: Padding): number => contentWidth(size, aspect, padding);
  return choices.reduce((best, each) => (width(each) > width(best) ? each : best));
}

/** The paddings that keep the control off the content: the same one if it is off already. */
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

/** Pixels that the content is wide when it is fitted. */
function contentWidth([width, height]: [number, number], aspect: number, [top, right, bottom, left]: Padding): number {
  return Math.min(width - left - right, (height - top - bottom) * aspect);
}
