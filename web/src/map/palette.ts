/** From the server's grey levels to the page's colours. */

export type Rgb = readonly [number, number, number];

export interface Palette {
  free: Rgb;
  occupied: Rgb;
}

/** The grey level of what nobody has seen. */
const kUnknownLevel = 128;

/**
 * Recolours grey levels in place: unknown becomes transparent, so that the page shows through; the surer a cell is free
 * or occupied, the more of that colour it takes.
 *
 * @param pixels RGBA with R the level: 0 occupied .. 255 free
 */
export function colourise(pixels: Uint8ClampedArray, table: Uint32Array): void {
  const words = new Uint32Array(pixels.buffer, pixels.byteOffset, pixels.length / 4);
  for (let pixel = 0; pixel < words.length; ++pixel) {
    words[pixel] = table[pixels[4 * pixel] ?? kUnknownLevel] ?? 0;
  }
}

/** One RGBA word, as canvases lay it out in memory, for each of the 256 levels. */
export function colourTable({ free, occupied }: Palette): Uint32Array {
  const bytes = new Uint8ClampedArray(256 * 4);
  for (let level = 0; level < 256; ++level) {
    const side = level < kUnknownLevel ? occupied : free;
    const reach = level < kUnknownLevel ? kUnknownLevel : 255 - kUnknownLevel;
    const opacity = Math.abs(level - kUnknownLevel) / reach;
    bytes.set([...side, Math.round(255 * opacity)], 4 * level);
  }
  return new Uint32Array(bytes.buffer);
}
