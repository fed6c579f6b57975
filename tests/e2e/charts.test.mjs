/** The charts of the server: rates, latencies, what is not told, and restarts. */
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { colourScheme, keepPicture, says } from './browser.mjs';
import { withFakeServer } from './fake_fixture.mjs';

const kTitles = ['Scans per second', 'Ack latency', 'Queue', 'CPU', 'Memory'];

describe("the server's charts", { timeout: 180_000 }, () => {
  let server;
  let page;
  const openPage = withFakeServer((fresh) => (server = fresh));

  const open = async (options) => {
    ({ page } = await openPage(options));
    await page.waitForSelector('#server-toggle', { state: 'attached' });
  };

  it('ask for nothing until someone opens them, and no longer when they are closed', async () => {
    server.metrics = metrics({ scans: 0 });
    await open();
    await says(page, '#sessions-state', /None yet/);
    assert.equal(await page.isVisible('#server'), false);
    assert.equal(server.metricsRequests, 0);
    await page.focus('#server-toggle');
    await page.keyboard.press('Enter');
    assert.equal(await page.getAttribute('#server-toggle', 'aria-expanded'), 'true');
    await says(page, valueOf('Memory'), /^95\.0 MB$/);
    await hide(true);
    await quiet();
    await hide(false);
    await polled('/metrics');
    await page.keyboard.press('Enter');
    assert.equal(await page.isVisible('#server'), false);
    await quiet();
  });

  it('tell rates, latencies, queue, processor and memory', async () => {
    server.metrics = metrics({ scans: 0 });
    await shown();
    await asked();
    server.metrics = metrics({ scans: 4000, cpu: 3, fast: 90, all: 100, inFlight: 7, queued: 1500 });
    await says(page, valueOf('Scans per second'), /^1\d{3}$|^2\d{3}$/);
    await says(page, valueOf('CPU'), /^\d\d+ %$/);
    await says(page, valueOf('Ack latency'), /^p50 5\.56, p99 91\.0$/);
    await says(page, valueOf('Queue'), /^7 scans, 1\.5 kB$/);
    await says(page, valueOf('Memory'), /^95\.0 MB$/);
    for (const title of kTitles) assert.ok(await drawn(title, '--robot-0'), `${title} is drawn`);
    assert.ok(await drawn('Ack latency', '--robot-1'), 'the slowest are a line of their own');
    await keepPicture(page, 'charts-light');
    await colourScheme(page, 'dark');
    assert.ok(await drawn('Memory', '--robot-0'), 'in the colours of the dark');
    await keepPicture(page, 'charts-dark');
  });

  it('never fall below nothing when the server starts again', async () => {
    server.metrics = metrics({ scans: 100_000, cpu: 500, fast: 9000, all: 9000 });
    await shown();
    await says(page, valueOf('Memory'), /MB/);
    await page.evaluate(() => {
      window.said = [];
      const look = () => window.said.push(document.querySelector('#server').textContent);
      new MutationObserver(look).observe(document.querySelector('#server'), { subtree: true, childList: true });
    });
    await asked();
    server.metrics = metrics({ scans: 10, cpu: 1, fast: 5, all: 5, started: 2000 });
    await asked();
    await says(page, valueOf('Scans per second'), /^\u2013$/);
    server.metrics = metrics({ scans: 50, cpu: 2, fast: 9, all: 9, started: 2000 });
    await says(page, valueOf('Scans per second'), /^[1-9][\d.]*$/);
    assert.ok((await page.evaluate(() => window.said)).every((text) => !/[-\u2212]\d/.test(text)));
  });

  it('say what this server does not tell', async () => {
    server.metrics = 'process_resident_memory_bytes 95e6\nscanloom_store_queued_bytes 0\n';
    await shown();
    await says(page, valueOf('Memory'), /^95\.0 MB$/);
    for (const title of ['Scans per second', 'Ack latency', 'CPU']) {
      await says(page, valueOf(title), /^not told by this server$/);
    }
    await says(page, valueOf('Queue'), /^0 B$/);
    await keepPicture(page, 'charts-partial');
  });

  it('keep what was known while the server is away, and say so', async () => {
    server.metrics = metrics({ scans: 0 });
    await shown();
    await says(page, valueOf('Memory'), /^95\.0 MB$/);
    await server.vanish();
    await says(page, '#server > [role=status]', /^Offline\. The charts show what was last heard\.$/);
    assert.ok(await drawn('Memory', '--line'));
    server.metrics = '<html>not metrics</html>';
    await server.comeBack();
    await says(page, '#server > [role=status]', /^$/);
  });

  it('fit a phone', async () => {
    server.metrics = metrics({ scans: 0 });
    await open({ size: [390, 844], scale: 2 });
    await page.click('#panel-toggle');
    await page.click('#server-toggle');
    await says(page, valueOf('Memory'), /^95\.0 MB$/);
    await page.locator('.chart').last().scrollIntoViewIfNeeded();
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing overflows');
    await keepPicture(page, 'charts-phone');
  });

  async function shown() {
    await open();
    await page.click('#server-toggle');
  }

  /** The page has asked once more, and what it heard is shown. */
  async function asked() {
    await polled('/metrics');
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  }

  /** The page asks all that it has to ask, as it does when the network comes back: nothing about the charts. */
  async function quiet() {
    const before = server.metricsRequests;
    for (let round = 0; round < 2; ++round) {
      const asked = polled('/api/v1/sessions');
      await page.evaluate(() => window.dispatchEvent(new Event('online')));
      await asked;
    }
    assert.equal(server.metricsRequests, before);
  }

  function hide(hidden) {
    return page.evaluate((value) => {
      Object.defineProperty(document, 'hidden', { value, configurable: true });
      document.dispatchEvent(new Event('visibilitychange'));
    }, hidden);
  }

  function polled(path) {
    return page.waitForResponse((response) => new URL(response.url()).pathname === path);
  }

  function valueOf(title) {
    return `.chart[data-title^="${title}"] .chart-value`;
  }

  /** Whether the colour is in the chart's picture. */
  async function drawn(title, name) {
    return page
      .waitForFunction(
        ([start, property]) => {
          const canvas = document.querySelector(`.chart[data-title^="${start}"] canvas`);
          if (!canvas) return false;
          const hex = getComputedStyle(document.documentElement).getPropertyValue(property).trim(); // as it is by now
          const colour = [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16));
          const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
          for (let at = 0; at < data.length; at += 4) {
            if (data[at + 3] > 120 && colour.every((part, band) => Math.abs(data[at + band] - part) < 24)) return true;
          }
          return false;
        },
        [title, name],
        { timeout: 10_000 },
      )
      .then(
        () => true,
        () => false,
      );
  }
});

/** @returns a page of /metrics as the server writes it */
function metrics({ scans, cpu = 1, fast = 0, all = 0, inFlight = 0, queued = 0, started = 1000 }) {
  return `# HELP scanloom_scans_applied_total Scans folded into maps.
# TYPE scanloom_scans_applied_total counter
scanloom_scans_applied_total ${scans}
scanloom_ack_seconds_bucket{le="0.01"} ${fast}
scanloom_ack_seconds_bucket{le="0.1"} ${all}
scanloom_ack_seconds_bucket{le="+Inf"} ${all}
scanloom_ack_seconds_sum ${all / 100}
scanloom_ack_seconds_count ${all}
scanloom_scans_in_flight ${inFlight}
scanloom_store_queued_bytes ${queued}
process_start_time_seconds ${started}
process_cpu_seconds_total ${cpu}
process_resident_memory_bytes 95000000
`;
}
