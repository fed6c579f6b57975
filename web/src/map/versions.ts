/** The tiles that contain data, and the revision of each one's last change. */
import type { TileChange } from '../api/types';

export class TileVersions {
  private readonly revisions = new Map<string, number>();

  /**
   * Applies changes. A newer revision is never replaced by an older one, in whatever order they arrive. The tiles above
   * a changed tile count as changed, too; the list may contain them or not.
   */
  apply(tiles: TileChange[]): void {
    for (const tile of tiles) {
      for (let { z, x, y } = tile; z >= 0; z -= 1, x >>= 1, y >>= 1) {
        const key = tileKey(z, x, y);
        // The tiles above already have this revision.
        if ((this.revisions.get(key) ?? -1) >= tile.revision) break;
        this.revisions.set(key, tile.revision);
      }
    }
  }

  /** @return undefined for a tile without data */
  get(z: number, x: number, y: number): number | undefined {
    return this.revisions.get(tileKey(z, x, y));
  }
}

export function tileKey(z: number, x: number, y: number): string {
  return `${z}/${x}/${y}`;
}
