import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import * as format from '../../../web/src/format';

describe('number formats', () => {
  it('group digits by thousands', () => {
    assert.equal(format.count(13631), '13\u202f631');
    assert.equal(format.count(999), '999');
    assert.equal(format.counted(1, 'scan'), '1 scan');
    assert.equal(format.counted(1234567, 'scan'), '1\u202f234\u202f567 scans');
    assert.equal(format.movingScans(13631), '13\u202f631 scans are being moved to corrected poses.');
    assert.equal(format.movingScans(1), '1 scan is being moved to corrected poses.');
  });

  it('use a typographic minus sign and no negative zero', () => {
    assert.equal(format.decimal(-1.5, 2), '\u22121.50');
    assert.equal(format.decimal(-0.001, 2), '0.00');
    assert.equal(format.integer(-64), '\u221264');
  });

  it('contain their unit', () => {
    assert.equal(format.length(12.34), '12.3 m');
    assert.equal(format.length(1500), '1.50 km');
    assert.equal(format.roundLength(0.2), '0.2 m');
    assert.equal(format.roundLength(2000), '2 km');
    assert.equal(format.cellSize(0.05), '5 cm');
    assert.equal(format.cellSize(0.125), '12.5 cm');
    assert.equal(format.cellSize(1), '1 m');
    assert.equal(format.area({ minX: -1, minY: 0, maxX: 2, maxY: 4.5 }), '3.0 \u00d7 4.5 m');
    assert.equal(format.pose({ x: 1, y: -0.5, yaw: -Math.PI / 2 }), 'x 1.00, y \u22120.50 m, \u221290\u00b0');
  });

  it('distinguish unknown from free cells', () => {
    assert.equal(format.cellValue({ kind: 'percent', percent: 0 }), '0 % occupied');
    assert.equal(format.cellValue({ kind: 'unknown' }), 'unknown');
  });
});

describe('text formats', () => {
  it('shorten between characters', () => {
    assert.equal(format.shortened('robot', 5), 'robot');
    assert.equal(format.shortened('roboter', 5), 'robo\u2026');
    assert.equal(format.shortened('\u{1f600}\u{1f600}\u{1f600}', 2), '\u{1f600}\u2026');
  });

  it('show an invalid date unchanged', () => {
    assert.equal(format.moment('yesterday'), 'yesterday');
  });
});
