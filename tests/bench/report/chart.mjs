/** Charts of measured points as SVG: both axes are logarithmic, so that a power of x is a straight line. */

const kWidth = 300;
const kHeight = 210;
const kLeft = 52;
const kRight = 12;
const kTop = 30;
const kBottom = 40;
const kFoot = 18; // height of the note below all charts

/**
 * @param {{title: string, x: string, y: string, points: [number, number][], expected?: number}[]} charts  `expected`: the power
 *     of x with which y may grow, drawn from the first point as a dashed line, as far as it stays within the frame
 */
export function drawCharts(charts, columns = 3) {
  const rows = Math.ceil(charts.length / columns);
  const parts = charts.map(
    (chart, n) =>
      `<g transform="translate(${(n % columns) * kWidth} ${Math.floor(n / columns) * kHeight})">${draw(chart)}</g>`,
  );
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${columns * kWidth} ${rows * kHeight + kFoot}" font-family="sans-serif" font-size="10">
<clipPath id="frame"><rect x="${kLeft}" y="${kTop}" width="${kWidth - kLeft - kRight}" height="${kHeight - kTop - kBottom}"/></clipPath>
<rect width="100%" height="100%" fill="#ffffff"/>
${parts.join('\n')}
<text x="${(columns * kWidth) / 2}" y="${rows * kHeight + 10}" text-anchor="middle">Both axes of every chart are logarithmic. Dashed: expected growth from the first point.</text>
</svg>
`;
}

function draw({ title, x, y, points, expected }) {
  const across = axis(
    points.map((point) => point[0]),
    kLeft,
    kWidth - kRight,
  );
  const up = axis(
    points.map((point) => point[1]),
    kHeight - kBottom,
    kTop,
    4,
  );
  const at = ([px, py]) => `${across.at(px).toFixed(1)},${up.at(py).toFixed(1)}`;
  const lines = [
    `<text x="${kLeft}" y="16" font-size="12" font-weight="bold">${title}</text>`,
    `<text x="${(kLeft + kWidth - kRight) / 2}" y="${kHeight - 8}" text-anchor="middle">${x}</text>`,
    `<text transform="translate(12 ${(kTop + kHeight - kBottom) / 2}) rotate(-90)" text-anchor="middle">${y}</text>`,
    ...across.ticks.map(
      (tick) =>
        `<path d="M${across.at(tick)} ${kTop}V${kHeight - kBottom}" stroke="#dddddd"/><text x="${across.at(tick)}" y="${kHeight - kBottom + 13}" text-anchor="middle">${label(tick)}</text>`,
    ),
    ...up.ticks.map(
      (tick) =>
        `<path d="M${kLeft} ${up.at(tick)}H${kWidth - kRight}" stroke="#dddddd"/><text x="${kLeft - 4}" y="${up.at(tick) + 3}" text-anchor="end">${label(tick)}</text>`,
    ),
  ];
  if (expected !== undefined) {
    const [firstX, firstY] = points[0];
    const guide = [points[0], [across.max, firstY * (across.max / firstX) ** expected]];
    lines.push(
      `<polyline points="${guide.map(at).join(' ')}" clip-path="url(#frame)" fill="none" stroke="#888888" stroke-dasharray="4 3"/>`,
    );
  }
  lines.push(`<polyline points="${points.map(at).join(' ')}" fill="none" stroke="#1f5fa8" stroke-width="1.5"/>`);
  lines.push(...points.map((point) => `<circle cx="${at(point).replace(',', '" cy="')}" r="2.5" fill="#1f5fa8"/>`));
  return lines.join('\n');
}

/** A logarithmic axis over the values; its end is at least `least` times its start. */
function axis(values, from, to, least = 1) {
  let min = Math.min(...values);
  let max = Math.max(...values);
  const missing = Math.sqrt(Math.max(1, least / (max / min)));
  min /= missing * 1.1;
  max *= missing * 1.1;
  const at = (value) => from + ((to - from) * Math.log(value / min)) / Math.log(max / min);
  const ticks = [];
  for (let power = Math.floor(Math.log10(min)); power <= Math.ceil(Math.log10(max)); ++power) {
    for (const digit of max / min > 300 ? [1] : [1, 2, 5]) {
      const tick = digit * 10 ** power;
      if (tick >= min && tick <= max) ticks.push(tick);
    }
  }
  return { at, ticks, min, max };
}

function label(value) {
  if (value >= 1e6) return `${value / 1e6}M`;
  if (value >= 1e3) return `${value / 1e3}k`;
  return `${Number(value.toPrecision(3))}`;
}
