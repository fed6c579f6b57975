/** Opens the viewer's page in Debian's Chromium, and reads values from it. */
import { existsSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { join } from 'node:path';
import { chromium } from 'playwright-core';
import { required } from './environment.mjs';

const kFlags = [
  '--no-sandbox',
  '--disable-gpu',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
];

/** The headless shell has no window, so it opens a page in less than half of the browser's processor time. */
const kBrowsers = ['/usr/bin/chromium-headless-shell', '/usr/bin/chromium'];

export const kWebDirectory = required('SCANLOOM_WEB_DIR');
const kPictureDirectory = required('SCANLOOM_PICTURE_DIR');

export function launchBrowser() {
  return chromium.launch({ executablePath: process.env.CHROMIUM ?? kBrowsers.find(existsSync), args: kFlags });
}

/**
 * Opens a new page with an empty cache. With `trusts`, it accepts any server certificate.
 *
 * @returns the page and its complaints: script errors, violations of the security policy, requests to other servers
 */
export async function openPage(
  browser,
  address,
  { hash = '', size = [1280, 800], scheme = 'light', scale = 1, motion = 'no-preference', trusts = '' } = {},
) {
  const context = await browser.newContext({
    viewport: { width: size[0], height: size[1] },
    colorScheme: scheme,
    deviceScaleFactor: scale,
    reducedMotion: motion,
    hasTouch: size[0] < 700 || size[1] < 500,
    ignoreHTTPSErrors: trusts === 'any certificate',
  });
  const complaints = [];
  const page = await openTab(context, address, complaints, hash);
  return { page, complaints };
}

/** Opens one more page in the same browser context, which shares the cache. */
export async function openTab(context, address, complaints, hash = '') {
  const page = await context.newPage();
  page.setDefaultTimeout(30_000);
  page.on('pageerror', (error) => complaints.push(`script error: ${error.stack ?? error}`));
  page.on('console', (message) => {
    if (message.text().includes('Content Security Policy')) complaints.push(message.text());
  });
  page.on('request', (request) => {
    const url = new URL(request.url());
    if (!['data:', 'blob:'].includes(url.protocol) && url.origin !== new URL(address).origin) {
      complaints.push(`request to another server: ${url}`);
    }
  });
  await page.goto(address + hash);
  return page;
}

/** Waits until an element's text matches. */
export async function hasText(page, selector, pattern) {
  await page.waitForFunction(
    ([where, source]) => new RegExp(source).test(document.querySelector(where)?.textContent ?? ''),
    [selector, pattern.source],
  );
}

export async function textOf(page, selector) {
  return (await page.textContent(selector)) ?? '';
}

/** Counts the pixels of the map's canvases that have this colour, ignoring alpha. */
export function countPixels(page, [red, green, blue]) {
  return page.evaluate(
    (wanted) => {
      let found = 0;
      for (const canvas of document.querySelectorAll('#map canvas')) {
        const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
        for (let at = 0; at < data.length; at += 4) {
          if (data[at + 3] > 200 && wanted.every((part, band) => Math.abs(data[at + band] - part) < 12)) found += 1;
        }
      }
      return found;
    },
    [red, green, blue],
  );
}

/** Returns the topmost colour of the map at a place in pixels of the page; null: nothing is drawn. */
export function colourAt(page, x, y) {
  return page.evaluate(
    ([left, top]) => {
      for (const canvas of [...document.querySelectorAll('#map canvas')].reverse()) {
        const box = canvas.getBoundingClientRect();
        const scale = canvas.width / box.width;
        const at = [(left - box.left) * scale, (top - box.top) * scale].map(Math.round);
        const { data } = canvas.getContext('2d').getImageData(at[0], at[1], 1, 1);
        if (data[3] > 127) return [...data.slice(0, 3)];
      }
      return null;
    },
    [x, y],
  );
}

/** Waits until the visible colour there is, or is not, this one. */
export function showsColourAt(page, [x, y], colour, wanted = true) {
  return until(page, async () => {
    const seen = await colourAt(page, x, y);
    return wanted === (seen !== null && isLike(seen, colour));
  });
}

/** Tolerance for smoothing. */
export function isLike(seen, colour, tolerance = 12) {
  return colour.every((part, band) => Math.abs(seen[band] - part) < tolerance);
}

/** Waits until this many pixels of the map have this colour. */
export function countsPixels(page, colour, holds) {
  return until(page, async () => holds(await countPixels(page, colour)));
}

/** Evaluates the condition in every frame of the page until it holds. */
export async function until(page, holds) {
  const deadline = Date.now() + 30_000;
  while (!(await holds())) {
    if (Date.now() > deadline) throw new Error('the map did not show the expected pixels in time');
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(resolve)));
  }
}

/** Changes the system's colour scheme, and waits until the page has applied it, which happens in a later frame. */
export async function colourScheme(page, scheme) {
  await page.emulateMedia({ colorScheme: scheme });
  await page.waitForSelector(`html[data-scheme="${scheme}"]`, { state: 'attached' });
}

/** Waits until the map shows one of these colours of the style sheet, at any opacity. */
export async function showsColour(page, ...names) {
  const colours = await Promise.all(names.map((name) => colourOf(page, name)));
  await page.waitForFunction((wanted) => {
    for (const canvas of document.querySelectorAll('#map canvas')) {
      const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
      for (let at = 0; at < data.length; at += 4) {
        if (data[at + 3] < 20) continue;
        if (wanted.some((colour) => colour.every((part, band) => Math.abs(data[at + band] - part) < 12))) return true;
      }
    }
    return false;
  }, colours);
}

/** Returns a colour of the style sheet as [red, green, blue]. */
export function colourOf(page, name) {
  return page.evaluate((property) => {
    const hex = getComputedStyle(document.documentElement).getPropertyValue(property).trim();
    return [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16));
  }, name);
}

export async function keepPicture(page, name) {
  await mkdir(kPictureDirectory, { recursive: true });
  await page.screenshot({ path: join(kPictureDirectory, `${name}.png`) });
}
