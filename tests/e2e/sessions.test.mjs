/** The list of all sessions: found, sorted, pictured, made and deleted. */
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { colourOf, colourScheme, keepPicture, says } from './browser.mjs';
import { withFakeServer } from './fake_fixture.mjs';
import { FakeSession } from './fake_session.mjs';

const kHostile = '"><img src=x onerror="document.title=1">';

describe('the list of sessions', { timeout: 240_000 }, () => {
  let server;
  let page;
  let complaints = [];
  const openPage = withFakeServer((fresh) => (server = fresh));

  const open = async (options) => ({ page, complaints } = await openPage(options));

  it('finds names by their parts, says how many of how many, and forgets the search on Escape', async () => {
    for (const name of ['lab-east', 'lab-west', 'hall']) painted(name);
    server.damaged.push({ name: 'lab-broken', reason: 'its log is damaged' });
    await open();
    await says(page, '#session-count', /^4 sessions$/);
    await page.focus('#map');
    await page.keyboard.press('/');
    await page.keyboard.type('LAB');
    await says(page, '#session-count', /^3 of 4 sessions$/);
    assert.deepEqual(await rows(), ['lab-east', 'lab-west']);
    await says(page, '#damaged', /lab-broken/);
    await page.keyboard.type(' we');
    await says(page, '#session-count', /^1 of 4 sessions$/);
    await page.keyboard.type('.*');
    await says(page, '#session-count', /^0 of 4 sessions$/);
    await page.keyboard.press('Escape');
    await says(page, '#session-count', /^4 sessions$/);
    assert.equal(await page.inputValue('#session-search'), '');
  });

  it('sorts by age, by name, and by how busy they are', async () => {
    const created = { a10: '2026-01-03', a9: '2026-01-01', b: '2026-01-02' };
    for (const [name, day] of Object.entries(created)) painted(name).created = `${day}T00:00:00Z`;
    await open();
    await says(page, '#session-count', /3/);
    assert.deepEqual(await rows(), ['a10', 'b', 'a9']);
    await page.selectOption('#session-order', 'name');
    assert.deepEqual(await rows(), ['a9', 'a10', 'b']);
    await page.selectOption('#session-order', 'busiest');
    for (let scan = 0; scan < 30; ++scan) server.sessions.get('b').move('r1', 1, 1, 0);
    await says(page, '[data-session="b"]', /30 scans · [1-9][\d.]* scans\/s/);
    await page.waitForFunction(() => document.querySelector('[data-session]').dataset.session === 'b');
  });

  it('does not move rows away under a pointer', async () => {
    for (const name of ['one', 'two', 'three']) painted(name);
    await open();
    await page.selectOption('#session-order', 'busiest');
    const order = await rows();
    await page.hover(`[data-session="${order[0]}"]`);
    const busy = server.sessions.get(order[2]);
    for (let scan = 0; scan < 50; ++scan) busy.move('r1', 1, 1, 0);
    await says(page, `[data-session="${order[2]}"]`, /scans\/s/);
    assert.deepEqual(await rows(), order);
    await page.hover('#map');
    await page.waitForFunction((name) => document.querySelector('[data-session]').dataset.session === name, order[2]);
  });

  it('tells size, scans, robots and state of each', async () => {
    const session = painted('map');
    session.move('r1', 1, 1, 0);
    session.move('r2', 1, 1, 0);
    session.robots[1].connected = false;
    server.add(new FakeSession('bare', 'id-bare')).failure = 'the disk is full';
    await open();
    await says(page, '[data-session="map"]', /online.*2 scans.*12\.8 × 12\.8 m · 1 of 2 online/);
    await says(page, '[data-session="bare"]', /takes no scans.*0 scans.*nothing seen yet · no robots.*disk is full/);
    assert.equal(await page.isVisible('[data-session="bare"] .online'), false);
  });

  it('pictures what is in view, and again only what has changed', async () => {
    painted('shown', 100);
    painted('other', 0);
    server.add(new FakeSession('empty', 'id-empty'));
    await open({ hash: '#session=empty' });
    await pictured('shown', '--cell-occupied');
    await pictured('other', '--cell-free');
    assert.equal(await page.getAttribute('[data-session="empty"] canvas', 'data-state'), 'empty');
    assert.equal(tilesOf('empty').length, 0);
    assert.deepEqual(tilesOf('other').length, 1, 'one tile at the zoom at which the map is small');
    const heard = countOf('/api/v1/sessions');
    // What the browser answers from its cache counts, too.
    const asked = [];
    page.on('request', (request) => asked.push(new URL(request.url()).pathname.split('/')));
    server.sessions.get('shown').paint(256, 255, 0);
    await pictured('shown', '--cell-free');
    assert.ok(countOf('/api/v1/sessions') - heard >= 3, 'not more often than each ten seconds');
    assert.deepEqual([tilesOf('shown').length, tilesOf('other').length], [2, 1]);
    assert.ok(
      asked.every(([, , , , name, part]) => name !== 'other' || part !== 'tiles'),
      'it has not changed',
    );
    assert.match(tilesOf('shown')[1], /\?v=2&id=id-shown$/);
    await colourScheme(page, 'dark');
    await pictured('shown', '--cell-free');
  });

  it('stays fluent with hundreds of sessions', async () => {
    for (let index = 0; index < 500; ++index) painted(`session-${String(index).padStart(3, '0')}`);
    await open();
    await says(page, '#session-count', /^500 sessions$/);
    await page.selectOption('#session-order', 'name');
    await page.evaluate(() => {
      window.longest = 0;
      new PerformanceObserver((list) => {
        for (const { duration } of list.getEntries()) window.longest = Math.max(window.longest, duration);
      }).observe({ type: 'longtask' });
    });
    for (let round = 0; round < 3; ++round) {
      for (const session of server.sessions.values()) session.move('r1', round, 1, 0);
      await page.waitForResponse((response) => new URL(response.url()).pathname === '/api/v1/sessions');
    }
    await says(page, '[data-session="session-499"]', /3 scans/);
    const longest = await page.evaluate(() => window.longest);
    assert.ok(longest < 400, `the page stood still for ${longest} ms`);
    const pictures = new Set(server.tileRequests.map((path) => path.split('/')[4]));
    assert.ok(pictures.size < 40, `${pictures.size} sessions were pictured, of a dozen in view`);
    await page.click('#session-search');
    await page.keyboard.type('session-49');
    await says(page, '#session-count', /^10 of 500 sessions$/);
    assert.equal((await rows()).length, 10);
    await keepPicture(page, 'sessions-many');
  });

  it('makes a session and opens it; a refusal is told in the dialog', async () => {
    painted('taken');
    await open();
    await page.click('#new-session');
    await page.fill('#new-name', 'not a name');
    await page.keyboard.press('Enter');
    assert.ok(await page.$eval('#new-name', (field) => field.validity.patternMismatch));
    await page.fill('#new-name', 'taken');
    await page.fill('#new-cell', '2');
    await page.keyboard.press('Enter');
    assert.ok(await page.$eval('#new-cell', (field) => field.validity.rangeOverflow));
    assert.deepEqual(server.wanted, [], 'nothing wrong is sent');
    await page.fill('#new-cell', '0.1');
    await page.check('#new-traversal');
    await page.keyboard.press('Enter');
    await says(page, '.dialog-failure', /Exists already: session 'taken' exists already/);
    await keepPicture(page, 'session-new-refused');
    await page.fill('#new-name', 'fresh_1');
    await page.keyboard.press('Enter');
    await page.waitForSelector('dialog', { state: 'hidden' });
    assert.deepEqual(server.wanted.at(-1), { name: 'fresh_1', cell_size: 0.1, ray_model: 'traversal' });
    await page.waitForSelector('#sessions a[aria-current]:has-text("fresh_1")');
    await says(page, '#notice', /fresh_1.*waits for the first scan/);
  });

  it('says in the dialog that the server is offline', async () => {
    await open();
    await says(page, '#notice', /No sessions yet/);
    await page.click('#new-session');
    await page.fill('#new-name', 'later');
    await server.vanish();
    await page.keyboard.press('Enter');
    await says(page, '.dialog-failure', /Offline/);
    await server.comeBack();
    await page.keyboard.press('Enter');
    await page.waitForSelector('#sessions a[aria-current]:has-text("later")');
  });

  it('deletes only what was confirmed, and goes on with another without a notice', async () => {
    painted('first').move('r1', 1, 1, 0);
    painted('second');
    await open({ hash: '#session=first' });
    await page.waitForSelector('#sessions a[aria-current]:has-text("first")');
    await page.click('[data-session="first"] .remove');
    await says(page, 'dialog[open]', /first · 1 scan, 1 robot.*log of scans and all its maps are deleted for good/);
    assert.equal(await page.evaluate(() => document.activeElement.textContent), 'Cancel');
    await keepPicture(page, 'session-delete');
    await page.keyboard.press('Escape');
    await page.waitForSelector('dialog[open]', { state: 'detached' });
    assert.ok(server.sessions.has('first'));
    await page.click('[data-session="first"] .remove');
    await page.evaluate(() => {
      window.told = [];
      const notice = document.querySelector('#notice');
      new MutationObserver(() => window.told.push(notice.textContent)).observe(notice, { childList: true });
    });
    // The page hears that the session is gone before it hears that it was deleted.
    let release;
    server.hold = new Promise((resolve) => (release = resolve));
    await page.click('dialog[open] .destructive');
    await says(page, '#notice', /Loading/);
    release();
    await page.waitForSelector('#sessions a[aria-current]:has-text("second")');
    await page.waitForSelector('#notice', { state: 'hidden' });
    assert.deepEqual(await rows(), ['second']);
    assert.equal(new URL(page.url()).hash, '#session=second');
    assert.ok(
      (await page.evaluate(() => window.told)).every((text) => !/deleted/.test(text)),
      'no notice',
    );
  });

  it('keeps a session that the server does not delete, and says why', async () => {
    painted('kept');
    await open();
    await page.click('[data-session="kept"] .remove');
    server.refusal = { status: 503, title: 'The store failed', detail: 'no space left' };
    await page.click('dialog[open] .destructive');
    await says(page, '.dialog[open] .dialog-failure', /The store failed: no space left/);
    await page.keyboard.press('Escape');
    assert.deepEqual(await rows(), ['kept']);
    server.sessions.delete('kept');
    await says(page, '#notice', /was deleted/);
  });

  it('deletes a damaged session, and the last one', async () => {
    server.damaged.push({ name: 'broken#7', reason: 'its log is damaged' });
    painted('last');
    await open();
    await page.click('[data-session="broken#7"] .remove');
    await page.click('dialog[open] .destructive');
    await page.waitForSelector('[data-session="broken#7"]', { state: 'detached' });
    assert.ok(server.requests.includes('DELETE /api/v1/sessions/broken%237'));
    await page.click('[data-session="last"] .remove');
    await page.click('dialog[open] .destructive');
    await says(page, '#notice', /No sessions yet/);
    await says(page, '#sessions-state', /None yet/);
  });

  it('is used by keyboard alone', async () => {
    for (const name of ['a', 'b', 'c']) painted(name);
    await open({ hash: '#session=c' });
    await says(page, '#session-count', /3/);
    await page.selectOption('#session-order', 'name');
    await page.keyboard.press('/');
    await page.keyboard.press('ArrowDown');
    assert.equal(await focused(), 'a');
    await page.keyboard.press('ArrowUp');
    assert.equal(await page.evaluate(() => document.activeElement.id), 'session-search');
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('End');
    assert.equal(await focused(), 'c');
    await page.keyboard.press('ArrowUp');
    await page.keyboard.press('Enter');
    await page.waitForSelector('#sessions a[aria-current]:has-text("b")');
    await page.keyboard.press('Tab');
    assert.equal(await page.evaluate(() => document.activeElement.getAttribute('aria-label')), 'Delete b');
    await page.keyboard.press('Enter');
    await page.waitForSelector('dialog[open]');
    await page.keyboard.press('Tab');
    await page.keyboard.press('Enter');
    await page.waitForSelector('[data-session="b"]', { state: 'detached' });
    assert.equal(await focused(), 'c', 'the focus goes to the next row');
    await page.keyboard.press('Delete');
    await says(page, 'dialog[open]', /c/);
    await page.keyboard.press('/');
    await page.keyboard.press('Enter');
    await page.waitForSelector('dialog[open]', { state: 'detached' });
    assert.deepEqual(await rows(), ['a', 'c'], 'Enter in the dialog cancels');
  });

  it('never turns a name into markup, nor cuts a request', async () => {
    painted(kHostile);
    await open();
    await page.click('.remove');
    await says(page, 'dialog[open]', /<img src=x/);
    await keepPicture(page, 'session-hostile');
    await page.click('dialog[open] .destructive');
    await says(page, '#sessions-state', /None yet/);
    assert.ok(server.requests.includes(`DELETE /api/v1/sessions/${encodeURIComponent(kHostile)}`));
    assert.equal(await page.locator('img').count(), 0);
  });

  it('says that it loads, is offline or cannot be had, and keeps what was known', async () => {
    painted('known');
    server.failure = { status: 503, title: 'Store not open', detail: 'recovering' };
    await open();
    await says(page, '#sessions-state', /cannot be had: Store not open: recovering\.$/);
    server.failure = null;
    await says(page, '#session-count', /^1 session$/);
    await says(page, '#sessions-state', /^$/);
    await server.vanish();
    await says(page, '#sessions-state', /^Offline\. The list shows what was last heard\.$/);
    assert.deepEqual(await rows(), ['known']);
    await server.comeBack();
    await says(page, '#sessions-state', /^$/);
  });

  it('fits a phone', async () => {
    painted('a-session-with-a-name-as-long-as-names-may-be-and-not-a-letter-m').move('r1', 1, 1, 0);
    painted('short');
    await open({ size: [390, 844], scale: 2 });
    await page.click('#panel-toggle');
    await pictured('short', '--cell-occupied');
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing overflows');
    await keepPicture(page, 'sessions-phone');
    await page.tap('[data-session="short"] .remove');
    await page.tap('dialog[open] button:has-text("Cancel")');
    await page.tap('#new-session');
    const box = await page.locator('dialog[open]').boundingBox();
    assert.ok(box.x >= 0 && box.x + box.width <= 390, JSON.stringify(box));
    await keepPicture(page, 'session-new-phone');
    await page.keyboard.press('Escape');
    await page.tap('#panel-toggle');
    await page.focus('#map');
    await page.keyboard.press('/');
    assert.ok(await page.isVisible('#session-search'), 'the search opens the panel');
  });

  /** A session with one tile right above the origin. */
  function painted(name, percent = 100) {
    const session = server.add(new FakeSession(name, `id-${name}`));
    session.paint(256, 255, percent);
    return session;
  }

  function rows() {
    return page.$$eval('#sessions [data-session]', (all) => all.map(({ dataset }) => dataset.session));
  }

  function focused() {
    return page.evaluate(() => document.activeElement.closest('[data-session]')?.dataset.session);
  }

  function countOf(path) {
    return server.requests.filter((each) => each === path).length;
  }

  function tilesOf(name) {
    return server.tileRequests.filter((path) => path.split('/')[4] === name);
  }

  async function pictured(name, colour) {
    const wanted = await colourOf(page, colour);
    const where = `[data-session="${name}"] canvas`;
    await page.waitForFunction(
      ([selector, [red, green, blue]]) => {
        const canvas = document.querySelector(selector);
        const { data } = canvas.getContext('2d').getImageData(canvas.width / 2, canvas.height / 2, 1, 1);
        return data[3] > 200 && [red, green, blue].every((part, band) => Math.abs(data[band] - part) < 6);
      },
      [where, wanted],
    );
  }
});
