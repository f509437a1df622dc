// Links that carry a file, and charts in other pages: what arrives is what was sent; a link that cannot be read says so and
// takes nothing away.
import assert from 'node:assert/strict';
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import jsQR from 'jsqr';
import type { Frame, Page } from 'playwright-core';
import { deflateSync } from 'node:zlib';
import { axe, browser, done, drawn, open, openWith, playground, serve, textOf, until, type Opened, type Site } from './lib';
import { share as words } from '../src/lib/words/share';

const LINE = '// Démarrage – « ligne 1 » 🙂\ninput go : BOOL\noutput motor : BOOL\n\nchart G1 {\n  initial step 0\n  step 1 {\n    N motor\n  }\n  0 -> 1 when go\n  1 -> 0 when not go\n}\n';
const MAIN = "use 'lib/part.g7'\n\ninput a : BOOL\n\nchart M {\n  initial step 0\n  step 1\n  0 -> 1 when Both(a, a)\n  1 -> 0 when not a\n}\n";
const PART = 'function Both(x : BOOL, y : BOOL) : BOOL {\n  Both := x and y\n}\n';
const PLANT = "input full : BOOL\noutput fill : BOOL\n\nchart T {\n  initial step 0\n  step 1 {\n    N fill\n  }\n  0 -> 1 when not full\n  1 -> 0 when full\n}\n\nplant Tank {\n  state level : REAL := 0.0\n  view 'tank.svg' {\n    water.height := level\n  }\n}\n";
const TANK = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><rect data-g7="water" x="10" y="10" width="80" height="20" fill="#36c"/></svg>';

/** Its comments do not shrink much. */
const LONG = LINE + Array.from({ length: 400 }, (_, n) => `// ${Math.sin(n)}\n`).join('');

const AT = { en: 0, fr: 1, pt: 2 } as const;

let b: Awaited<ReturnType<typeof browser>>;
let site: Site;
/** A playground without examples. */
let bare: Site;

before(async () => {
  [site, bare, b] = await Promise.all([playground({ 'work/line.g7': LINE, 'work/main.g7': MAIN, 'work/lib/part.g7': PART, 'work/plant.g7': PLANT, 'work/tank.svg': TANK, 'work/long.g7': LONG }), playground({}), browser()]);
});

after(async () => {
  await b?.done();
  await Promise.all([site?.stop(), bare?.stop()]);
  for (const server of lessons) {
    server.closeAllConnections();
    server.close();
  }
});

const field = (page: Page, name: string) => page.getByRole('textbox', { name, exact: true });

/** The link of the visible file, from its `#` on. */
async function linkOf(page: Page): Promise<string> {
  await page.getByRole('button', { name: 'Share by link', exact: true }).click();
  await until(async () => (await field(page, 'Link').inputValue()).includes('#g7.1.'), 'a link is made');
  const link = await field(page, 'Link').inputValue();
  await page.keyboard.press('Escape');
  return link.slice(link.indexOf('#'));
}

/** A link of this content, as a program that is not the page makes it. */
const made = (content: unknown, version = 1): string => `#g7.${version}.${deflateSync(Buffer.from(JSON.stringify(content))).toString('base64url')}.g7`;

/** Opens an address in a window of its own. */
const at = (url: string, settings: object = { language: 'en' }): Promise<Opened> =>
  open(b, { ...bare, url }, undefined, { width: 1280, height: 800 }, (context) => context.addInitScript((text) => localStorage.getItem('g7-prefs') ?? localStorage.setItem('g7-prefs', text), JSON.stringify(settings)));

const tabs = (page: Page) => page.getByRole('tablist', { name: 'Open files' }).getByRole('tab');
const symbol = (page: Page | Frame, id: string) => page.locator(`.sheet [data-id="${id}"]`);

test('a link carries the file to the last byte, and leaves the address clean', async () => {
  const sender = await openWith(b, site, 'work/line.g7', { language: 'en' });
  const hash = await linkOf(sender);
  const asked = site.fetched?.length ?? 0;
  const page = await at(bare.url + hash);
  await symbol(page, 'G1/s/1').waitFor({ state: 'attached' });
  assert.equal(await textOf(page), LINE);
  assert.equal(new URL(page.url()).hash, '', 'the address does not bring the old text back');
  assert.equal(site.fetched?.length, asked, 'nothing was fetched from the page of the sender');
  assert.deepEqual(await tabs(page).allInnerTexts(), ['work/line.g7\nnot saved'], 'it is one unsaved file');
  // A change that is made here stays when the window is loaded again.
  await page.getByRole('button', { name: 'Text', exact: true }).click();
  await page.locator('.cm-content').click();
  await page.keyboard.press('Control+Home');
  await page.keyboard.type('// mine ');
  await page.waitForFunction(() => Object.values(localStorage).some((text) => text.includes('// mine ')));
  await page.reload();
  await page.locator('.cm-content').waitFor();
  assert.equal(await textOf(page), `// mine ${LINE}`);
  await done(page);
  await done(sender);
});

test('a link made elsewhere opens, also in a window that is open already', async () => {
  const page = await at(bare.url);
  await page.getByRole('button', { name: /Blank chart/ }).waitFor();
  await page.evaluate((hash) => (location.hash = hash), made({ file: 'a.g7', text: LINE, uses: [], pictures: [] }));
  await symbol(page, 'G1/s/1').waitFor({ state: 'attached' });
  assert.equal(await textOf(page), LINE);
  await done(page);
});

test('a link that was cut, changed, made by a later version or too large is told, and nothing is lost', async () => {
  const whole = made({ file: 'b.g7', text: LINE, uses: [], pictures: [] });
  const middle = Math.floor(whole.length / 2);
  const cuts = [whole.slice(0, -1), whole.slice(0, -3), whole.slice(0, middle), '#g7.1.', '#g7.', '#g7.1', '#g7.x.abc.g7', `${whole.slice(0, middle)}${whole.slice(middle + 4)}`, `${whole.slice(0, middle)}%%${whole.slice(middle)}`];
  const strange = [null, 7, {}, { file: 'a.g7', text: 3, uses: [], pictures: [] }, { file: '', text: LINE, uses: [], pictures: [] }, { file: '../a.g7', text: LINE, uses: [], pictures: [] }, { file: 'a.g7', text: LINE, uses: [{ file: '/etc/a.g7', text: '' }], pictures: [] }, { file: 'a.g7', text: LINE }].map((content) => made(content));
  const large = [made({ file: 'a.g7', text: ' '.repeat(5_000_000), uses: [], pictures: [] }), made({ file: 'a.g7', text: 'x', uses: [], pictures: [{ file: 'a.svg', text: '\u0800'.repeat(9_000_000) }] })];
  const page = await at(bare.url + made({ file: 'kept.g7', text: LINE, uses: [], pictures: [] }));
  await symbol(page, 'G1/s/1').waitFor({ state: 'attached' });
  const told = page.locator('.notice.error');
  for (const [hashes, expected] of [
    [[...cuts, ...strange], words['share.cut'][0]],
    [[made({ file: 'a.g7', text: LINE }, 2), made({}, 30)], words['share.later'][0]],
    [large, words['share.large'][0]],
  ] as const) {
    for (const hash of hashes) {
      await page.evaluate((to) => (location.hash = to), hash);
      await told.waitFor();
      assert.equal((await told.innerText()).trim(), expected, hash.slice(0, 60));
      await told.getByRole('button').click();
      assert.deepEqual(await tabs(page).allInnerTexts(), ['kept.g7\nnot saved'], hash.slice(0, 60));
    }
  }
  await page.evaluate(() => (location.hash = '#other'));
  assert.equal(await textOf(page), LINE, 'the open file is what it was');
  assert.equal(await told.count(), 0, 'an address that carries no file is no broken link');
  await done(page);
  for (const [language, at_] of [['fr', 1], ['pt', 2]] as const) {
    const page = await at(bare.url + (cuts[0] ?? ''), { language });
    await page.locator('.notice.error').waitFor();
    assert.equal((await page.locator('.notice.error').innerText()).trim(), words['share.cut'][at_]);
    await done(page);
  }
});

test('a file of the same name stays; the one of the link stands beside it', async () => {
  const page = await openWith(b, site, 'work/line.g7', { language: 'en' });
  const other = LINE.replace('motor', 'engine').replace('N motor', 'N engine');
  await page.evaluate((hash) => (location.hash = hash), made({ file: 'work/line.g7', text: other, uses: [], pictures: [] }));
  await until(async () => (await tabs(page).count()) === 2, 'a second file is open');
  assert.equal(await textOf(page), other, 'it is shown');
  await tabs(page).first().click();
  assert.equal(await textOf(page), LINE);
  // The same text again is the same file.
  await page.evaluate((hash) => (location.hash = hash), made({ file: 'work/line.g7', text: LINE, uses: [], pictures: [] }));
  await page.waitForFunction(() => location.hash === '');
  await drawn(page);
  assert.equal(await tabs(page).count(), 2);
  await done(page);
});

test('the files that it uses and the picture of its plant come with it', async () => {
  const sender = await openWith(b, site, 'work/main.g7', { language: 'en' });
  const page = await at(bare.url + (await linkOf(sender)));
  await symbol(page, 'M/s/1').waitFor({ state: 'attached' });
  assert.deepEqual((await tabs(page).allInnerTexts()).map((name) => name.split('\n')[0]), ['lib/part.g7', 'work/main.g7']);
  await page.getByRole('button', { name: 'One scan', exact: true }).click();
  await page.getByRole('switch', { name: /a$/ }).first().click();
  await page.getByRole('button', { name: 'One scan', exact: true }).click();
  await until(async () => (await symbol(page, 'M/s/1').getAttribute('aria-label'))?.includes('active') ?? false, 'the function of the other file works');
  await done(page);
  await sender.goto(`${site.url}?file=work/plant.g7`);
  await symbol(sender, 'T/s/1').waitFor({ state: 'attached' });
  const second = await at(bare.url + (await linkOf(sender)));
  for (const _ of [1, 2]) {
    await symbol(second, 'T/s/1').waitFor({ state: 'attached' });
    await second.getByRole('button', { name: 'One scan', exact: true }).click();
    await second.locator('[data-g7="water"]').waitFor({ state: 'attached' });
    await second.reload();
  }
  await done(second);
  await done(sender);
});

test('the QR code is the link', async () => {
  const page = await openWith(b, site, 'work/line.g7', { language: 'en' });
  await page.getByRole('button', { name: 'Share by link', exact: true }).click();
  const image = page.getByRole('img', { name: 'QR code of the link' });
  await image.waitFor();
  const link = await field(page, 'Link').inputValue();
  const size = 700;
  // The canvas of the page gives the brightness of each point, as base64: an array of millions would take long.
  const grey = await image.evaluate(async (img: HTMLImageElement, size) => {
    await img.decode();
    const to = Object.assign(document.createElement('canvas'), { width: size, height: size }).getContext('2d') as CanvasRenderingContext2D;
    to.drawImage(img, 0, 0, size, size);
    const { data } = to.getImageData(0, 0, size, size);
    return btoa(Array.from({ length: size * size }, (_, n) => String.fromCharCode(data[4 * n] ?? 0)).join(''));
  }, size);
  const pixels = Uint8ClampedArray.from([...Buffer.from(grey, 'base64')].flatMap((v) => [v, v, v, 255]));
  assert.equal(jsQR(pixels, size, size)?.data, link);
  await done(page);
  const long = await openWith(b, site, 'work/long.g7', { language: 'en' });
  await long.getByRole('button', { name: 'Share by link', exact: true }).click();
  await long.getByText(/too long for a QR code/).waitFor();
  assert.equal(await long.getByRole('img', { name: 'QR code of the link' }).count(), 0);
  await done(long);
});

const lessons: Server[] = [];

/** A page of another origin with this body; its address. */
async function elsewhere(body: string, more: Record<string, string> = {}): Promise<string> {
  const server = createServer((request, response) => {
    const text = more[(request.url ?? '/').slice(1)];
    if (text !== undefined) response.writeHead(200, { 'content-type': 'text/plain' }).end(text);
    else if (request.url === '/') response.writeHead(200, { 'content-type': 'text/html; charset=utf-8' }).end(`<!doctype html><title>A lesson</title><h1>A lesson</h1>${body}`);
    else response.writeHead(404).end();
  });
  await new Promise<void>((listening) => server.listen(0, '127.0.0.1', listening));
  lessons.push(server);
  return `http://localhost:${(server.address() as AddressInfo).port}/`;
}

/** Runs the chart of a frame as its reader does. */
async function runs(frame: Frame): Promise<void> {
  await symbol(frame, 'G1/s/1').waitFor({ state: 'attached' });
  await frame.getByRole('button', { name: 'One scan', exact: true }).click();
  await frame.getByRole('button', { name: 'Right side', exact: true }).or(frame.getByRole('button', { name: 'Operate', exact: true })).first().click();
  await frame.getByRole('switch', { name: /go$/ }).first().click();
  await frame.getByRole('button', { name: 'One scan', exact: true }).click();
  await until(async () => (await symbol(frame, 'G1/s/1').getAttribute('aria-label'))?.includes('active') ?? false, 'step 1 is active in the frame');
  const kept = await frame.evaluate(() => {
    try {
      return Object.keys(localStorage).concat(Object.keys(sessionStorage));
    } catch {
      return [];
    }
  });
  assert.deepEqual(kept, [], 'a frame keeps nothing in the browser');
}

const frameOf = async (page: Page, n = 0): Promise<Frame> => {
  await until(async () => page.frames().length > n + 1, 'the frame is there');
  return page.frames()[n + 1] as Frame;
};

test('the code of the dialog shows a living chart in a page elsewhere', async () => {
  const page = await openWith(b, site, 'work/line.g7', { language: 'en' });
  await page.getByRole('button', { name: 'Share by link', exact: true }).click();
  for (const name of ['As a frame', 'As an element with its text']) {
    const code = await page.getByRole('region', { name, exact: true }).innerText();
    const lesson = await elsewhere(code);
    const reader = await open(b, { ...bare, url: lesson });
    const frame = await frameOf(reader);
    await runs(frame);
    const onward = frame.getByRole('link', { name: 'Open in G7' });
    assert.equal(await onward.getAttribute('target'), '_blank');
    const whole = await at((await onward.getAttribute('href')) ?? '');
    await symbol(whole, 'G1/s/1').waitFor({ state: 'attached' });
    assert.equal(await textOf(whole), LINE, name);
    await done(whole);
    await done(reader);
  }
  await done(page);
});

test('an element takes its chart from its text, a script in it or a file, and its attributes', async () => {
  const lesson = await elsewhere(
    `<script src="${bare.url}embed.js" defer></script>
    <g7-chart view="text" lang="fr" theme="dark" height="300px"><script type="text/plain">
      input a, b : BOOL
      chart G1 {
        initial step 0
        step 1
        0 -> 1 when a and b<b>
      }
    </script></g7-chart>
    <g7-chart src="line.g7"></g7-chart><g7-chart lang="fr" src="none.g7"></g7-chart>`,
    { 'line.g7': LINE },
  );
  const page = await open(b, { ...bare, url: lesson });
  const first = await frameOf(page, 0);
  await first.locator('.cm-content').waitFor();
  assert.match(await first.locator('.cm-content').innerText(), /^input a, b : BOOL\nchart G1 {\n  initial step 0/);
  assert.match(await first.locator('.cm-content').innerText(), /b<b>/);
  assert.equal(await first.evaluate(() => `${document.documentElement.lang} ${document.documentElement.dataset.theme}`), 'fr dark');
  assert.equal(await page.locator('g7-chart iframe').first().evaluate((e) => e.clientHeight), 300);
  const second = await frameOf(page, 1);
  await symbol(second, 'G1/s/1').waitFor({ state: 'attached' });
  assert.equal(await page.locator('g7-chart p').innerText(), 'Le grafcet de none.g7 ne peut pas être lu.');
  assert.equal(await page.locator('g7-chart iframe').count(), 2);
  assert.deepEqual(page.errors.filter((text) => !text.includes('404')), []);
  await page.context().close();
});

test('a page of a server gives the address that others can reach', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'g7-share-'));
  writeFileSync(join(folder, 'line.g7'), LINE);
  const own = await serve(folder);
  const page = await openWith(b, own, 'line.g7', { language: 'en' });
  await page.getByRole('button', { name: 'Share by link', exact: true }).click();
  await page.getByText('This is the address of your own server.').waitFor();
  await until(async () => (await field(page, 'Link').inputValue()).includes('#g7.1.'), 'a link is made');
  assert.ok(!(await field(page, 'Link').inputValue()).includes('token'), 'the link gives no access to the server');
  assert.equal(await page.getByRole('region', { name: 'As a frame' }).count(), 0, 'the server lets no page show it');
  await field(page, 'Address of the page that opens it').fill('ftp://x');
  await page.getByText('This is no address of a page').waitFor();
  assert.equal(await field(page, 'Link').inputValue(), '');
  await field(page, 'Address of the page that opens it').fill(bare.url);
  await page.getByRole('region', { name: 'As a frame' }).waitFor();
  const other = await at(await field(page, 'Link').inputValue());
  await symbol(other, 'G1/s/1').waitFor({ state: 'attached' });
  assert.equal(await textOf(other), LINE);
  await done(other);
  await done(page);
  await own.stop();
  rmSync(folder, { recursive: true });
});

for (const [language, title] of [['en', 'Share by link'], ['fr', 'Partager par lien'], ['pt', 'Partilhar por ligação']] as const) {
  test(`axe finds nothing wrong in the dialog and in a frame, ${language}`, async () => {
    const page = await openWith(b, site, 'work/line.g7', { language });
    await page.getByRole('button', { name: title, exact: true }).click();
    await page.getByRole('dialog', { name: title }).getByRole('img').waitFor();
    assert.deepEqual(await axe(page), []);
    await done(page);
    const frame = await at(`${bare.url}?embed&lang=${language}${made({ file: 'a.g7', text: LINE, uses: [], pictures: [] })}`);
    await symbol(frame, 'G1/s/1').waitFor({ state: 'attached' });
    assert.deepEqual(await axe(frame), []);
    await done(frame);
    const empty = await at(`${bare.url}?embed&lang=${language}`);
    await empty.getByText(words['share.nothing'][AT[language]]).waitFor();
    await done(empty);
  });
}
