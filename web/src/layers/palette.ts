/** Maps the server's colours to the page's. */
import type { CellClass } from './cell_value';
import type { LayerName } from './layers';

export type Rgb = readonly [number, number, number];

/** The page's colours of cells. Unknown cells are transparent and show the page's background. */
export interface Palette {
  free: Rgb;
  occupied: Rgb;
  /** Colours of the HIMM counters 0, 5, 10, 15. */
  counters: readonly [Rgb, Rgb, Rgb, Rgb];
  classes: Record<Exclude<CellClass, 'unexplored'>, Rgb>;
}

/** One RGBA word, in the memory layout of canvases, for each red value that the server's tiles of a layer can have. */
export type ColourTable = Uint32Array;

const kUnknownLevel = 128;
export const kCounterMax = 15;
/** Difference in grey level between two successive counters. */
const kCounterStep = 17;
/** The red component of each class's colour; all are different. */
const kRedOfClass: Record<keyof Palette['classes'], number> = { occupied: 67, danger: 217, frontier: 46, free: 255 };

/** Recolours in place. @param pixels RGBA from the server */
export function colourise(pixels: Uint8ClampedArray, table: ColourTable): void {
  const words = new Uint32Array(pixels.buffer, pixels.byteOffset, pixels.length / 4);
  for (let pixel = 0; pixel < words.length; ++pixel) {
    words[pixel] = table[pixels[4 * pixel] ?? kUnknownLevel] ?? 0;
  }
}

export function colourTable(layer: LayerName, palette: Palette): ColourTable {
  const bytes = new Uint8ClampedArray(256 * 4);
  const put = (red: number, colour: Rgb, opacity = 1): void =>
    bytes.set([...colour, Math.round(255 * opacity)], 4 * red);
  if (layer === 'classification') {
    for (const [name, red] of Object.entries(kRedOfClass)) put(red, palette.classes[name as keyof Palette['classes']]);
  } else if (layer === 'himm') {
    for (let count = 0; count <= kCounterMax; ++count) put(255 - kCounterStep * count, counterColour(palette, count));
  } else {
    for (let level = 0; level < 256; ++level) put(level, ...probabilityColour(palette, level));
  }
  return new Uint32Array(bytes.buffer);
}

/** The more certain a cell is free or occupied, the more of that colour. @param level 0 occupied .. 255 free */
function probabilityColour({ free, occupied }: Palette, level: number): [Rgb, number] {
  const reach = level < kUnknownLevel ? kUnknownLevel : 255 - kUnknownLevel;
  return [level < kUnknownLevel ? occupied : free, Math.abs(level - kUnknownLevel) / reach];
}

/** Linear interpolation between the palette's colours. */
export function counterColour({ counters }: Palette, count: number): Rgb {
  const at = (count / kCounterMax) * (counters.length - 1);
  const low = Math.min(Math.floor(at), counters.length - 2);
  const [from, to] = [counters[low] ?? counters[0], counters[low + 1] ?? counters[3]];
  const mix = (band: 0 | 1 | 2): number => Math.round(from[band] + (to[band] - from[band]) * (at - low));
  return [mix(0), mix(1), mix(2)];
}
