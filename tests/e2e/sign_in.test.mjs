/** A server that requires tokens: sign in, continue after expiry, sign out. */
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { keepPicture, launchBrowser, openPage, hasText } from './browser.mjs';
import { required } from './environment.mjs';
import { Server } from './programs.mjs';

describe('a server with tokens', () => {
  const place = mkdtempSync(join(tmpdir(), 'scanloom-tokens-'));
  const file = join(place, 'tokens.toml');
  let operator;
  let viewer;
  let server;
  let browser;

  before(async () => {
    operator = makeToken('chief', 'operator', '*');
    viewer = makeToken('kiosk', 'viewer', 'depot');
    writeFileSync(file, operator.lines + viewer.lines, { mode: 0o600 });
    server = await Server.start(['--tokens', file]);
    for (const name of ['depot', 'lab']) assert.equal(await create(name), 201);
    browser = await launchBrowser();
  });

  after(async () => {
    await browser?.close();
    await server?.stop();
    rmSync(place, { recursive: true, force: true });
  });

  it('requires a token, and shows the sessions of the token', async () => {
    const { page, complaints } = await openPage(browser, server.address, { hash: '#session=depot' });
    await page.waitForSelector('dialog[open] #token');
    await hasText(page, 'dialog[open]', /This server requires a token\./);
    assert.equal(await page.isVisible('#sign-in'), false);
    await polledAgain(page);
    for (const other of ['#status', '#notice', '#sessions-state'])
      assert.equal(await page.isVisible(other), false, other);
    await keepPicture(page, 'sign-in');
    await signIn(page, 'scanloom_guess');
    await hasText(page, 'dialog[open] .dialog-failure', /not valid here/);
    await page.keyboard.press('Escape');
    assert.equal(await page.isVisible('dialog[open] #token'), true);
    await signIn(page, viewer.secret);
    await hasText(page, '#session-count', /^1 session$/);
    await hasText(page, '#sign-in', /kiosk \(viewer\)/);
    await hasText(page, '#chosen', /^depot$/);
    assert.equal(await page.isVisible('dialog[open]'), false);
    const cookies = await page.context().cookies();
    assert.equal(cookies.length, 1);
    assert.equal(cookies[0].httpOnly, true);
    assert.equal(cookies[0].sameSite, 'Strict');
    assert.equal(cookies[0].value.includes(viewer.secret), false);
    assert.equal(await page.evaluate(() => document.cookie), '');
    assert.deepEqual(complaints, []);
    await page.context().close();
  });

  it('lets an operator change sessions, and continues after signing in again', async () => {
    const { page } = await openPage(browser, server.address);
    await page.waitForSelector('dialog[open] #token');
    await signIn(page, operator.secret);
    await hasText(page, '#session-count', /^2 sessions$/);
    await page.click('#new-session');
    await page.fill('#new-name', 'attic');
    await page.keyboard.press('Enter');
    await hasText(page, '#chosen', /^attic$/);
    const address = page.url();
    await page.context().clearCookies(); // as after a restart of the server
    await page.waitForSelector('dialog[open] #token');
    await hasText(page, 'dialog[open]', /Your session has expired\./);
    await signIn(page, operator.secret);
    await hasText(page, '#session-count', /^3 sessions$/);
    assert.equal(page.url(), address);
    await hasText(page, '#chosen', /^attic$/);
    await page.context().close();
  });

  it('signs out', async () => {
    const { page } = await openPage(browser, server.address);
    await page.waitForSelector('dialog[open] #token');
    await signIn(page, viewer.secret);
    await hasText(page, '#sign-in', /kiosk/);
    const [cookie] = await page.context().cookies();
    await page.click('#sign-in button');
    await page.waitForSelector('dialog[open] #token');
    assert.deepEqual(await page.context().cookies(), []);
    const answer = await fetch(`${server.address}api/v1/sessions`, {
      headers: { Cookie: `${cookie.name}=${cookie.value}` },
    });
    assert.equal(answer.status, 401);
    await page.context().close();
  });

  /** Waits until the page has received 401 for each of its polls. */
  async function polledAgain(page) {
    for (let answers = 0; answers < 2; ++answers) await page.waitForResponse((answer) => answer.status() === 401);
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(resolve)));
  }

  async function signIn(page, secret) {
    await page.fill('#token', secret);
    await page.keyboard.press('Enter');
  }

  async function create(name) {
    const answer = await fetch(`${server.address}api/v1/sessions`, {
      method: 'POST',
      headers: { Authorization: `Bearer ${operator.secret}`, 'Content-Type': 'application/json' },
      body: JSON.stringify({ name }),
    });
    return answer.status;
  }
});

/** Creates a token with the server's command. */
function makeToken(name, role, session) {
  const program = join(required('SCANLOOM_BIN_DIR'), 'scanloom-server');
  const text = execFileSync(program, ['token', '--name', name, '--role', role, '--session', session], {
    encoding: 'utf8',
  });
  const [secret, ...lines] = text.split('\n');
  return { secret, lines: lines.join('\n') };
}
