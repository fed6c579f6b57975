/** Which tiles hold anything, and the revision that touched each last. */
import type { TileChange } from '../api/types';

export class TileVersions {
  private readonly revisions = new Map<string, number>();

  /**
   * An older revision never replaces a newer one, whatever the order of arrival.
   * What lies above a tile has changed with it: it may be told or left out.
   */
  apply(tiles: TileChange[]): void {
    for (const tile of tiles) {
      for (let { z, x, y } = tile; z >= 0; z -= 1, x >>= 1, y >>= 1) {
        const key = tileKey(z, x, y);
        // Who is as new as this has told those above it already.
        if ((this.revisions.get(key) ?? -1) >= tile.revision) break;
        this.revisions.set(key, tile.revision);
      }
    }
  }

  /** @return undefined for a tile that nothing ever touched */
  get(z: number, x: number, y: number): number | undefined {
    return this.revisions.get(tileKey(z, x, y));
  }
}

export function tileKey(z: number, x: number, y: number): string {
  return `${z}/${x}/${y}`;
}
