/** Selects the tiles of a session's thumbnail, and the part of them to show. */
import type { Bounds } from '../api/types';
import { kNativeZoom, kTileSize, squareExtent, tileResolutions } from '../map/grid';

/** Larger pictures would only be reduced again. */
const kSpanMax = 128;

export interface ThumbnailTile {
  z: number;
  x: number;
  y: number;
  /** Position of the tile's upper left corner, in pixels of the picture. */
  left: number;
  top: number;
}

export interface ThumbnailPlan {
  /** Size of the picture, pixels. */
  width: number;
  height: number;
  tiles: ThumbnailTile[];
}

/** @return at most four tiles, of the finest zoom at which the bounds fit the pixel limit */
export function planThumbnail(bounds: Bounds, cellSize: number): ThumbnailPlan {
  const { zoom, resolution } = zoomOf(bounds, cellSize);
  const [left, , , top] = squareExtent(cellSize);
  const edge = kTileSize * 2 ** zoom - 1;
  const column = (x: number): number => Math.min(edge, Math.max(0, Math.floor((x - left) / resolution)));
  const row = (y: number): number => Math.min(edge, Math.max(0, Math.floor((top - y) / resolution)));
  // A bound on a pixel's edge does not include the next pixel.
  const within = resolution * 1e-6;
  const first = { column: column(bounds.minX + within), row: row(bounds.maxY - within) };
  const last = {
    column: Math.max(first.column, column(bounds.maxX - within)),
    row: Math.max(first.row, row(bounds.minY + within)),
  };
  const tiles: ThumbnailTile[] = [];
  for (let y = tileOf(first.row); y <= tileOf(last.row); ++y) {
    for (let x = tileOf(first.column); x <= tileOf(last.column); ++x) {
      tiles.push({ z: zoom, x, y, left: x * kTileSize - first.column, top: y * kTileSize - first.row });
    }
  }
  return { width: last.column - first.column + 1, height: last.row - first.row + 1, tiles };
}

function tileOf(pixel: number): number {
  return Math.floor(pixel / kTileSize);
}

function zoomOf({ minX, minY, maxX, maxY }: Bounds, cellSize: number): { zoom: number; resolution: number } {
  const span = Math.max(maxX - minX, maxY - minY);
  const resolutions = tileResolutions(cellSize);
  for (let zoom = kNativeZoom; zoom > 0; --zoom) {
    const resolution = resolutions[zoom] ?? cellSize;
    if (span <= kSpanMax * resolution) return { zoom, resolution };
  }
  return { zoom: 0, resolution: resolutions[0] ?? cellSize };
}
