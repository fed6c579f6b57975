/** Which tiles hold anything, and the revision that touched each last. */
import type { TileChange } from '../api/types';

export class TileVersions {
  private readonly revisions = new Map<string, number>();

  /** An older revision never replaces a newer one, whatever the order of arrival. */
  apply(tiles: TileChange[]): void {
    for (const tile of tiles) {
      const key = tileKey(tile.z, tile.x, tile.y);
      if (tile.revision > (this.revisions.get(key) ?? -1)) this.revisions.set(key, tile.revision);
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
