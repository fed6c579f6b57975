import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { parseMetrics, type Samples } from '../../../../web/src/charts/prometheus';

function values(samples: Samples, name: string): number[] | undefined {
  return samples.get(name)?.map(({ value }) => value);
}

describe('metrics text', () => {
  it('is parsed line by line', () => {
    const comments = '# HELP a What it is.\n# TYPE a counter\n';
    const samples = parseMetrics(`${comments}a 12\r\nb{x="1"} 1.5e+3 1700000000000\n\nb{x="2"} -4\n`);
    assert.deepEqual([...samples.keys()], ['a', 'b']);
    assert.deepEqual(values(samples, 'a'), [12]);
    assert.deepEqual(values(samples, 'b'), [1500, -4]);
    assert.equal(samples.get('b')?.[1]?.labels.get('x'), '2');
  });

  it('may contain any characters in label values', () => {
    const [sample] = parseMetrics('m{ a="x, {\\"}\\\\\\n" , b="", le="+Inf",} 7').get('m') ?? [];
    assert.deepEqual(
      [...(sample?.labels ?? [])],
      [
        ['a', 'x, {"}\\\n'],
        ['b', ''],
        ['le', '+Inf'],
      ],
    );
    assert.equal(sample?.value, 7);
  });

  it('parses infinity and NaN', () => {
    assert.deepEqual(values(parseMetrics('a +Inf\na -Inf\na NaN\na Nan'), 'a'), [Infinity, -Infinity, NaN, NaN]);
  });

  it('is skipped where it is invalid', () => {
    const samples = parseMetrics('<html>\n{a="1"} 3\na\na{ 1\na{b="1" 2\na{b=1} 2\na x\na 1 2 3\na 5');
    assert.deepEqual([...samples.keys()], ['a']);
    assert.deepEqual(values(samples, 'a'), [5]);
  });
});
