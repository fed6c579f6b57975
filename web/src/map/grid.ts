/**
 * Positions of cells and tiles. A square of side S = 256 * cell_size * 2^9 is centred on the world's origin; zoom 0
 * shows it as one tile, zoom 9 shows one cell per pixel. Cells (i, j) follow the world's axes; tile rows count
 * downwards.
 */

export const kTileSize = 256;
export const kNativeZoom = 9;
/** Half the square's side in cells: the lower left corner of cell (0, 0) is the origin. */
const kHalfSideCells = (kTileSize * 2 ** kNativeZoom) / 2;

export interface Cell {
  i: number;
  j: number;
}

/** A cell's tile at the native zoom, and its pixel there (row 0 on top). */
export interface CellPlace {
  x: number;
  y: number;
  column: number;
  row: number;
}

/** [min_x, min_y, max_x, max_y] of the square, metres. */
export function squareExtent(cellSize: number): [number, number, number, number] {
  const half = kHalfSideCells * cellSize;
  return [-half, -half, half, half];
}

/** Metres per pixel for zoom 0 .. 9. */
export function tileResolutions(cellSize: number): number[] {
  return Array.from({ length: kNativeZoom + 1 }, (_, zoom) => cellSize * 2 ** (kNativeZoom - zoom));
}

export function cellAt(x: number, y: number, cellSize: number): Cell {
  return { i: Math.floor(x / cellSize), j: Math.floor(y / cellSize) };
}

/** @return null outside the square */
export function placeOfCell({ i, j }: Cell): CellPlace | null {
  const column = i + kHalfSideCells;
  const row = kHalfSideCells - 1 - j;
  const side = 2 * kHalfSideCells;
  if (column < 0 || column >= side || row < 0 || row >= side) return null;
  return {
    x: Math.floor(column / kTileSize),
    y: Math.floor(row / kTileSize),
    column: column % kTileSize,
    row: row % kTileSize,
  };
}
