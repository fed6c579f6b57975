/** The part of the map's width in which a layer is visible. */

/** From 0 on the left to 1. */
export interface Clip {
  from: number;
  to: number;
}

/** Clips the following drawing to this part. */
export function clipTo(context: CanvasRenderingContext2D, { from, to }: Clip): void {
  const { width, height } = context.canvas;
  context.beginPath();
  context.rect(from * width, 0, (to - from) * width, height);
  context.clip();
}
