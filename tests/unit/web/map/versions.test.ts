import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { TileVersions } from '../../../../web/src/map/versions';

describe('tile versions', () => {
  it('are undefined for unchanged tiles', () => {
    assert.equal(new TileVersions().get(9, 1, 2), undefined);
  });

  it('keep the newest revision of each tile, independent of order', () => {
    const versions = new TileVersions();
    versions.apply([{ z: 9, x: 1, y: 2, revision: 7 }]);
    versions.apply([
      { z: 9, x: 1, y: 2, revision: 5 },
      { z: 8, x: 1, y: 2, revision: 6 },
    ]);
    assert.equal(versions.get(9, 1, 2), 7);
    assert.equal(versions.get(8, 1, 2), 6);
    assert.equal(versions.get(9, 2, 1), undefined);
  });

  it('update all parent tiles', () => {
    const versions = new TileVersions();
    versions.apply([{ z: 9, x: 257, y: 255, revision: 7 }]);
    assert.equal(versions.get(8, 128, 127), 7);
    assert.equal(versions.get(0, 0, 0), 7);
    versions.apply([{ z: 9, x: 256, y: 255, revision: 5 }]);
    assert.equal(versions.get(9, 256, 255), 5);
    assert.equal(versions.get(8, 128, 127), 7, 'the parent of both tiles has the newer revision');
    versions.apply([{ z: 9, x: 256, y: 255, revision: 9 }]);
    assert.equal(versions.get(8, 128, 127), 9);
    assert.equal(versions.get(0, 0, 0), 9);
  });
});
