/** The part of the map's width that something is seen in. */

/** From 0 on the left to 1. */
export interface Clip {
  from: number;
  to: number;
}

/** What is drawn from now on is seen there only. */
export function clipTo(context: CanvasRenderingContext2D, { from, to }: Clip): void {
  const { width, height } = context.canvas;
  context.beginPath();
  context.rect(from * width, 0, (to - from) * width, height);
  context.clip();
}
