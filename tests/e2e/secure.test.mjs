/** The viewer over TLS: pages, tiles, WebSockets, and a cookie for TLS only. */
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { launchBrowser, openPage, hasText } from './browser.mjs';
import { required } from './environment.mjs';
import { ended, Server, startRobot } from './programs.mjs';

describe('a server with TLS', () => {
  const place = mkdtempSync(join(tmpdir(), 'scanloom-secure-'));
  let server;
  let browser;

  before(async () => {
    server = await Server.start(certificateOptions());
    browser = await launchBrowser();
  });

  after(async () => {
    await browser?.close();
    await server?.stop();
    rmSync(place, { recursive: true, force: true });
  });

  it('shows a growing map', async () => {
    const address = server.address.replace('http:', 'https:');
    const { page, complaints } = await openPage(browser, address, {
      hash: '#session=office',
      trusts: 'any certificate',
    });
    const sockets = [];
    page.on('websocket', (socket) => sockets.push(socket.url()));
    const robot = startRobot(server, 'office', 'r1', [
      'simulate',
      '--world',
      'office',
      '--speed',
      '0',
      '--scans',
      '100',
    ]);
    assert.equal(await ended(robot), 0);
    await hasText(page, '#sessions', /100 scans/);
    await page.reload();
    await hasText(page, '#facts', /100/);
    assert.ok(sockets.length > 0);
    for (const socket of sockets) assert.match(socket, /^wss:/);
    assert.deepEqual(complaints, []);
    await page.context().close();
  });

  it('signs in with a cookie that is sent over TLS only', async () => {
    const program = join(required('SCANLOOM_BIN_DIR'), 'scanloom-server');
    const made = execFileSync(program, ['token', '--name', 'kiosk', '--role', 'viewer'], { encoding: 'utf8' });
    const tokens = join(place, 'tokens.toml');
    writeFileSync(tokens, made.slice(made.indexOf('\n')), { mode: 0o600 });
    const guarded = await Server.start([...certificateOptions(), '--tokens', tokens]);
    try {
      const { page } = await openPage(browser, guarded.address.replace('http:', 'https:'), {
        trusts: 'any certificate',
      });
      await page.waitForSelector('dialog[open] #token');
      await page.fill('#token', made.slice(0, made.indexOf('\n')));
      await page.keyboard.press('Enter');
      await hasText(page, '#sign-in', /kiosk \(viewer\)/);
      assert.deepEqual(
        (await page.context().cookies()).map((cookie) => cookie.secure),
        [true],
      );
      await page.context().close();
    } finally {
      await guarded.stop();
    }
  });

  function certificateOptions() {
    const [certificate, key] = ['chain.pem', 'key.pem'].map((name) => join(place, name));
    execFileSync(
      'openssl',
      [
        ...['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:P-256', '-nodes', '-days', '2'],
        ...['-subj', '/CN=test', '-addext', 'subjectAltName=IP:127.0.0.1', '-keyout', key, '-out', certificate],
      ],
      { stdio: 'ignore' },
    );
    return ['--http-tls-cert', certificate, '--http-tls-key', key];
  }
});
