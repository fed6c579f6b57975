/** Starts a fake server for each test of a file, in one browser; after each test the page must have no complaints. */
import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach } from 'node:test';
import { kWebDirectory, launchBrowser, openPage } from './browser.mjs';
import { FakeServer } from './fake_server.mjs';

/**
 * Call once within describe().
 *
 * @param begin called with each test's server before the test
 * @returns a function that opens the page like openPage() and returns it with its complaints
 */
export function withFakeServer(begin) {
  let browser;
  let server;
  let opened = null;

  before(async () => (browser = await launchBrowser()));
  after(() => browser?.close());
  beforeEach(async () => {
    server = await FakeServer.start(kWebDirectory);
    await begin(server);
  });
  afterEach(async () => {
    await opened?.page.context().close();
    await server.vanish().catch(() => {});
    assert.deepEqual(opened?.complaints ?? [], []);
    opened = null;
  });

  return async (options) => (opened = await openPage(browser, server.address, options));
}
