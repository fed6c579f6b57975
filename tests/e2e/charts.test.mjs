/** The charts of the server: rates, latencies, metrics that are not reported, and restarts. */
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { colourScheme, keepPicture, hasText } from './browser.mjs';
import { withFakeServer } from './fake_fixture.mjs';

const kTitles = ['Scans per second', 'Ack latency', 'Queue', 'CPU', 'Memory'];

describe("the server's charts", () => {
  let server;
  let page;
  const openPage = withFakeServer((fresh) => (server = fresh));

  const open = async (options) => {
    ({ page } = await openPage(options));
    await page.waitForSelector('#server-toggle', { state: 'attached' });
  };

  it('poll only while they are open', async () => {
    server.metrics = metrics({ scans: 0 });
    await open();
    await hasText(page, '#sessions-state', /No sessions yet/);
    assert.equal(await page.isVisible('#server'), false);
    assert.equal(server.metricsRequests, 0);
    await page.focus('#server-toggle');
    await page.keyboard.press('Enter');
    assert.equal(await page.getAttribute('#server-toggle', 'aria-expanded'), 'true');
    await hasText(page, valueOf('Memory'), /^95\.0 MB$/);
    await hide(true);
    await quiet();
    await hide(false);
    await polled('/metrics');
    await page.keyboard.press('Enter');
    assert.equal(await page.isVisible('#server'), false);
    await quiet();
  });

  it('show rates, latencies, queue, CPU and memory', async () => {
    server.metrics = metrics({ scans: 0 });
    await shown();
    await nextPoll();
    server.metrics = metrics({ scans: 4000, cpu: 3, fast: 90, all: 100, inFlight: 7, queued: 1500 });
    await hasText(page, valueOf('Scans per second'), /^1\d{3}$|^2\d{3}$/);
    await hasText(page, valueOf('CPU'), /^\d\d+ %$/);
    await hasText(page, valueOf('Ack latency'), /^p50 5\.56, p99 91\.0$/);
    await hasText(page, valueOf('Queue'), /^7 scans, 1\.5 kB$/);
    await hasText(page, valueOf('Memory'), /^95\.0 MB$/);
    for (const title of kTitles) assert.ok(await drawn(title, '--robot-0'), `${title} is drawn`);
    assert.ok(await drawn('Ack latency', '--robot-1'), 'the 99th percentile has its own line');
    await keepPicture(page, 'charts-light');
    await colourScheme(page, 'dark');
    assert.ok(await drawn('Memory', '--robot-0'), 'with the dark scheme');
    await keepPicture(page, 'charts-dark');
  });

  it('show no negative rate after a restart of the server', async () => {
    server.metrics = metrics({ scans: 100_000, cpu: 500, fast: 9000, all: 9000 });
    await shown();
    await hasText(page, valueOf('Memory'), /MB/);
    await page.evaluate(() => {
      window.said = [];
      const look = () => window.said.push(document.querySelector('#server').textContent);
      new MutationObserver(look).observe(document.querySelector('#server'), { subtree: true, childList: true });
    });
    await nextPoll();
    server.metrics = metrics({ scans: 10, cpu: 1, fast: 5, all: 5, started: 2000 });
    await nextPoll();
    await hasText(page, valueOf('Scans per second'), /^\u2013$/);
    server.metrics = metrics({ scans: 50, cpu: 2, fast: 9, all: 9, started: 2000 });
    await hasText(page, valueOf('Scans per second'), /^[1-9][\d.]*$/);
    assert.ok((await page.evaluate(() => window.said)).every((text) => !/[-\u2212]\d/.test(text)));
  });

  it('mark metrics that the server does not report', async () => {
    server.metrics = 'process_resident_memory_bytes 95e6\nscanloom_store_queued_bytes 0\n';
    await shown();
    await hasText(page, valueOf('Memory'), /^95\.0 MB$/);
    for (const title of ['Scans per second', 'Ack latency', 'CPU']) {
      await hasText(page, valueOf(title), /^not reported by this server$/);
    }
    await hasText(page, valueOf('Queue'), /^0 B$/);
    await keepPicture(page, 'charts-partial');
  });

  it('keep the last values while the server is offline, and say so', async () => {
    server.metrics = metrics({ scans: 0 });
    await shown();
    await hasText(page, valueOf('Memory'), /^95\.0 MB$/);
    await server.vanish();
    await hasText(page, '#server > [role=status]', /^Offline\. The charts show the last received values\.$/);
    assert.ok(await drawn('Memory', '--line'));
    server.metrics = '<html>not metrics</html>';
    await server.comeBack();
    await hasText(page, '#server > [role=status]', /^$/);
  });

  it('fit a phone', async () => {
    server.metrics = metrics({ scans: 0 });
    await open({ size: [390, 844], scale: 2 });
    await page.click('#panel-toggle');
    await page.click('#server-toggle');
    await hasText(page, valueOf('Memory'), /^95\.0 MB$/);
    await page.locator('.chart').last().scrollIntoViewIfNeeded();
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing overflows');
    await keepPicture(page, 'charts-phone');
  });

  async function shown() {
    await open();
    await page.click('#server-toggle');
  }

  /** Waits until the page has polled once more and shows the answer. */
  async function nextPoll() {
    await polled('/metrics');
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  }

  /** Makes the page run all its polls, as when the network comes back: none of them is for the charts. */
  async function quiet() {
    const before = server.metricsRequests;
    for (let round = 0; round < 2; ++round) {
      const response = polled('/api/v1/sessions');
      await page.evaluate(() => window.dispatchEvent(new Event('online')));
      await response;
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

  /** Whether the chart's canvas contains the colour. */
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

/** @returns a page of /metrics in the format of the server */
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
