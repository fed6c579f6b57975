/** The list of sessions: search, order, thumbnails, creation and deletion. */
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { colourOf, colourScheme, keepPicture, hasText } from './browser.mjs';
import { withFakeServer } from './fake_fixture.mjs';
import { FakeSession } from './fake_session.mjs';

const kHostile = '"><img src=x onerror="document.title=1">';

describe('the list of sessions', () => {
  let server;
  let page;
  let complaints = [];
  const openPage = withFakeServer((fresh) => (server = fresh));

  const open = async (options) => ({ page, complaints } = await openPage(options));

  it('finds names by their parts, shows the counts, and clears the search on Escape', async () => {
    for (const name of ['lab-east', 'lab-west', 'hall']) painted(name);
    server.damaged.push({ name: 'lab-broken', reason: 'its log is damaged' });
    await open();
    await hasText(page, '#session-count', /^4 sessions$/);
    await page.focus('#map');
    await page.keyboard.press('/');
    await page.keyboard.type('LAB');
    await hasText(page, '#session-count', /^3 of 4 sessions$/);
    assert.deepEqual(await rows(), ['lab-east', 'lab-west']);
    await hasText(page, '#damaged', /lab-broken/);
    await page.keyboard.type(' we');
    await hasText(page, '#session-count', /^1 of 4 sessions$/);
    await page.keyboard.type('.*');
    await hasText(page, '#session-count', /^0 of 4 sessions$/);
    await page.keyboard.press('Escape');
    await hasText(page, '#session-count', /^4 sessions$/);
    assert.equal(await page.inputValue('#session-search'), '');
  });

  it('sorts by age, by name, and by scan rate', async () => {
    const created = { a10: '2026-01-03', a9: '2026-01-01', b: '2026-01-02' };
    for (const [name, day] of Object.entries(created)) painted(name).created = `${day}T00:00:00Z`;
    await open();
    await hasText(page, '#session-count', /3/);
    assert.deepEqual(await rows(), ['a10', 'b', 'a9']);
    await page.selectOption('#session-order', 'name');
    assert.deepEqual(await rows(), ['a9', 'a10', 'b']);
    await page.selectOption('#session-order', 'busiest');
    for (let scan = 0; scan < 30; ++scan) server.sessions.get('b').move('r1', 1, 1, 0);
    await hasText(page, '[data-session="b"]', /30 scans · [1-9][\d.]* scans\/s/);
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
    await hasText(page, `[data-session="${order[2]}"]`, /scans\/s/);
    assert.deepEqual(await rows(), order);
    await page.hover('#map');
    await page.waitForFunction((name) => document.querySelector('[data-session]').dataset.session === name, order[2]);
  });

  it('shows size, scans, robots and state of each session', async () => {
    const session = painted('map');
    session.move('r1', 1, 1, 0);
    session.move('r2', 1, 1, 0);
    session.robots[1].connected = false;
    server.add(new FakeSession('bare', 'id-bare')).failure = 'the disk is full';
    await open();
    await hasText(page, '[data-session="map"]', /online.*2 scans.*12\.8 × 12\.8 m · 1 of 2 online/);
    await hasText(page, '[data-session="bare"]', /accepts no scans.*0 scans.*no scans yet · no robots.*disk is full/);
    assert.equal(await page.isVisible('[data-session="bare"] .online'), false);
  });

  it('loads thumbnails in view, and again only after a change', async () => {
    painted('shown', 100);
    painted('other', 0);
    server.add(new FakeSession('empty', 'id-empty'));
    await open({ hash: '#session=empty' });
    await pictured('shown', '--cell-occupied');
    await pictured('other', '--cell-free');
    assert.equal(await page.getAttribute('[data-session="empty"] canvas', 'data-state'), 'empty');
    assert.equal(tilesOf('empty').length, 0);
    assert.deepEqual(tilesOf('other').length, 1, 'one tile at the zoom at which the map is small');
    const polls = countOf('/api/v1/sessions');
    // Answers from the browser's cache count, too.
    const requested = [];
    page.on('request', (request) => requested.push(new URL(request.url()).pathname.split('/')));
    server.sessions.get('shown').paint(256, 255, 0);
    await pictured('shown', '--cell-free');
    assert.ok(countOf('/api/v1/sessions') - polls >= 3, 'at most once in ten seconds');
    assert.deepEqual([tilesOf('shown').length, tilesOf('other').length], [2, 1]);
    assert.ok(
      requested.every(([, , , , name, part]) => name !== 'other' || part !== 'tiles'),
      'it has not changed',
    );
    assert.match(tilesOf('shown')[1], /\?v=2&id=id-shown$/);
    await colourScheme(page, 'dark');
    await pictured('shown', '--cell-free');
  });

  it('keeps the rows of hundreds of sessions, and loads the thumbnails in view', async () => {
    for (let index = 0; index < 500; ++index) painted(`session-${String(index).padStart(3, '0')}`);
    await open();
    await hasText(page, '#session-count', /^500 sessions$/);
    await page.selectOption('#session-order', 'name');
    await page.evaluate(() => {
      window.made = 0;
      new MutationObserver((changes) => {
        for (const { addedNodes } of changes)
          window.made += [...addedNodes].filter((node) => node instanceof Element).length;
      }).observe(document.querySelector('#sessions'), { childList: true, subtree: true });
    });
    for (let round = 0; round < 3; ++round) {
      for (const session of server.sessions.values()) session.move('r1', round, 1, 0);
      await page.waitForResponse((response) => new URL(response.url()).pathname === '/api/v1/sessions');
    }
    await hasText(page, '[data-session="session-499"]', /3 scans/);
    const made = await page.evaluate(() => window.made);
    assert.ok(made < 40, `${made} elements were made, although no session is new`);
    const pictures = new Set(server.tileRequests.map((path) => path.split('/')[4]));
    assert.ok(pictures.size < 40, `${pictures.size} thumbnails were loaded, of a dozen in view`);
    await page.click('#session-search');
    await page.keyboard.type('session-49');
    await hasText(page, '#session-count', /^10 of 500 sessions$/);
    assert.equal((await rows()).length, 10);
    await keepPicture(page, 'sessions-many');
  });

  it('creates a session and opens it; the dialog shows a refusal', async () => {
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
    assert.deepEqual(server.wanted, [], 'invalid names are not sent');
    await page.fill('#new-cell', '0.1');
    await page.check('#new-traversal');
    await page.keyboard.press('Enter');
    await hasText(page, '.dialog-failure', /Exists already: session 'taken' exists already/);
    await keepPicture(page, 'session-new-refused');
    await page.fill('#new-name', 'fresh_1');
    await page.keyboard.press('Enter');
    await page.waitForSelector('dialog[open]', { state: 'detached' });
    assert.deepEqual(server.wanted.at(-1), { name: 'fresh_1', cell_size: 0.1, ray_model: 'traversal' });
    await page.waitForSelector('#sessions a[aria-current]:has-text("fresh_1")');
    await hasText(page, '#notice', /fresh_1.*waits for the first scan/);
  });

  it('says in the dialog that the server is offline', async () => {
    await open();
    await hasText(page, '#notice', /No sessions yet/);
    await page.click('#new-session');
    await page.fill('#new-name', 'later');
    await server.vanish();
    await page.keyboard.press('Enter');
    await hasText(page, '.dialog-failure', /Offline/);
    await server.comeBack();
    await page.keyboard.press('Enter');
    await page.waitForSelector('#sessions a[aria-current]:has-text("later")');
  });

  it('deletes only after confirmation, and opens another session without a notice', async () => {
    painted('first').move('r1', 1, 1, 0);
    painted('second');
    await open({ hash: '#session=first' });
    await page.waitForSelector('#sessions a[aria-current]:has-text("first")');
    await page.click('[data-session="first"] .remove');
    await hasText(
      page,
      'dialog[open]',
      /first · 1 scan, 1 robot.*log of scans and all its maps are deleted permanently/,
    );
    assert.equal(await page.evaluate(() => document.activeElement.textContent), 'Cancel');
    await keepPicture(page, 'session-delete');
    await page.keyboard.press('Escape');
    await page.waitForSelector('dialog[open]', { state: 'detached' });
    assert.ok(server.sessions.has('first'));
    await page.click('[data-session="first"] .remove');
    await page.evaluate(() => {
      window.notices = [];
      const notice = document.querySelector('#notice');
      new MutationObserver(() => window.notices.push(notice.textContent)).observe(notice, { childList: true });
    });
    // The live connection ends before the page receives the answer to the deletion.
    let release;
    server.hold = new Promise((resolve) => (release = resolve));
    await page.click('dialog[open] .destructive');
    await hasText(page, '#notice', /Loading/);
    release();
    await page.waitForSelector('#sessions a[aria-current]:has-text("second")');
    await page.waitForSelector('#notice', { state: 'hidden' });
    assert.deepEqual(await rows(), ['second']);
    assert.equal(new URL(page.url()).hash, '#session=second');
    assert.ok(
      (await page.evaluate(() => window.notices)).every((text) => !/deleted/.test(text)),
      'no notice',
    );
  });

  it('keeps a session that the server does not delete, and shows the reason', async () => {
    painted('kept');
    await open();
    await page.click('[data-session="kept"] .remove');
    server.refusal = { status: 503, title: 'The store failed', detail: 'no space left' };
    await page.click('dialog[open] .destructive');
    await hasText(page, '.dialog[open] .dialog-failure', /The store failed: no space left/);
    await page.keyboard.press('Escape');
    assert.deepEqual(await rows(), ['kept']);
    server.sessions.delete('kept');
    await hasText(page, '#notice', /was deleted/);
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
    await hasText(page, '#notice', /No sessions yet/);
    await hasText(page, '#sessions-state', /No sessions yet/);
  });

  it('works with the keyboard alone', async () => {
    for (const name of ['a', 'b', 'c']) painted(name);
    await open({ hash: '#session=c' });
    await hasText(page, '#session-count', /3/);
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
    assert.equal(await focused(), 'c', 'the focus moves to the next row');
    await page.keyboard.press('Delete');
    await hasText(page, 'dialog[open]', /c/);
    await page.keyboard.press('/');
    await page.keyboard.press('Enter');
    await page.waitForSelector('dialog[open]', { state: 'detached' });
    assert.deepEqual(await rows(), ['a', 'c'], 'Enter in the dialog cancels');
  });

  it('escapes names in markup and in requests', async () => {
    painted(kHostile);
    await open();
    await page.click('.remove');
    await hasText(page, 'dialog[open]', /<img src=x/);
    await keepPicture(page, 'session-hostile');
    await page.click('dialog[open] .destructive');
    await hasText(page, '#sessions-state', /No sessions yet/);
    assert.ok(server.requests.includes(`DELETE /api/v1/sessions/${encodeURIComponent(kHostile)}`));
    assert.equal(await page.locator('img').count(), 0);
  });

  it('reports loading, errors and offline, and keeps the last list', async () => {
    painted('known');
    server.failure = { status: 503, title: 'Store not open', detail: 'recovering' };
    await open();
    await hasText(page, '#sessions-state', /cannot be loaded: Store not open: recovering\.$/);
    server.failure = null;
    await hasText(page, '#session-count', /^1 session$/);
    await hasText(page, '#sessions-state', /^$/);
    await server.vanish();
    await hasText(page, '#sessions-state', /^Offline\. The list shows the last received state\.$/);
    assert.deepEqual(await rows(), ['known']);
    await server.comeBack();
    await hasText(page, '#sessions-state', /^$/);
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

  /** Returns a session with one tile, its lower left corner at the origin. */
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
        if (!canvas) return false; // the list is drawn a little later
        const { data } = canvas.getContext('2d').getImageData(canvas.width / 2, canvas.height / 2, 1, 1);
        return data[3] > 200 && [red, green, blue].every((part, band) => Math.abs(data[band] - part) < 6);
      },
      [where, wanted],
    );
  }
});
