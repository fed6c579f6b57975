/** The longest round length (1, 2 or 5 times a power of ten) that fits a scale bar. */

export interface ScaleStep {
  metres: number;
  pixels: number;
}

/** @param resolution metres per pixel, positive */
export function scaleStep(resolution: number, pixelsMax: number): ScaleStep {
  const longest = resolution * pixelsMax;
  const power = 10 ** Math.floor(Math.log10(longest));
  const factor = [5, 2, 1].find((candidate) => candidate * power <= longest) ?? 1;
  const metres = factor * power;
  return { metres, pixels: metres / resolution };
}
