// Users: the first admin, roles, a revoked session, and the log, with a controller behind TLS.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { LYING, telephone, UPRIGHT } from './finger';
import { axe, browser, open, speak } from './lib';
import { Machine } from './machine';

const PASSWORD = 'correct horse';
const PHONE = { width: 390, height: 844 };
let b: Awaited<ReturnType<typeof browser>>;
let machine: Machine;
let code: string;

before(async () => {
  b = await browser();
  ({ machine, code } = await Machine.guarded());
});

after(async () => {
  await machine?.done();
  await b?.done();
});

const button = (page: Page, name: string) => page.getByRole('button', { name, exact: true });
const visit = (size?: { width: number; height: number }) => open(b, { url: machine.url, stop: async () => undefined }, undefined, size);

async function login(page: Page, name: string, password = PASSWORD): Promise<void> {
  await page.getByLabel('Name', { exact: true }).fill(name);
  await page.getByLabel('Password', { exact: true }).fill(password);
  await button(page, 'Log in').click();
}

async function fits(page: Page): Promise<void> {
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true, 'it fits a phone');
}

test('users come in by role, see what they lack, and are put out', async () => {
  // The first admin, on a phone.
  const ana = await visit(PHONE);
  await ana.getByRole('heading', { name: 'The first admin' }).waitFor();
  assert.deepEqual(await axe(ana), [], 'the first admin');
  await fits(ana);
  const fill = async (given: string) => {
    await ana.getByLabel('Code').fill(given);
    await ana.getByLabel('Name', { exact: true }).fill('ana');
    await ana.getByLabel('New password').fill(PASSWORD);
    await ana.getByLabel('The password once more').fill(PASSWORD);
    await button(ana, 'Become the first admin').click();
  };
  await fill('0000-0000-0000-0000');
  await ana.getByRole('alert').getByText('the code is wrong').waitFor();
  await fill(code);
  await ana.locator('.mode.stop').waitFor();
  await fits(ana);
  // The cookie is out of the reach of scripts.
  assert.equal(await ana.evaluate(() => document.cookie), '');
  const [cookie] = await ana.context().cookies();
  assert.deepEqual([cookie?.name, cookie?.httpOnly, cookie?.secure, cookie?.sameSite], ['__Host-g7', true, true, 'Strict']);

  // Another user.
  await button(ana, 'Users').click();
  const users = ana.getByRole('dialog', { name: 'Users' });
  await users.getByLabel('Name', { exact: true }).fill('vi');
  await users.getByRole('combobox', { name: 'Role', exact: true }).selectOption({ label: 'viewer' });
  await users.getByLabel('New password').fill('short');
  await button(ana, 'Add').click();
  await users.getByRole('alert').getByText('at least 10 letters').waitFor();
  await users.getByLabel('New password').fill(PASSWORD);
  await button(ana, 'Add').click();
  await users.getByLabel('Role of vi').waitFor();
  assert.deepEqual(await axe(ana), [], 'the users');
  await fits(ana);
  await button(ana, 'Close').click();

  const vi = await visit();
  await vi.getByRole('heading', { name: 'Log in' }).waitFor();
  assert.deepEqual(await axe(vi), [], 'the login');
  await login(vi, 'vi', 'wrong password');
  await vi.getByRole('alert').getByText('name or password is wrong').waitFor();
  await login(vi, 'vi');
  await vi.locator('.mode.stop').waitFor();
  assert.equal(await button(vi, 'Start').isEnabled(), false);
  assert.equal(await button(vi, 'Start').getAttribute('title'), 'needs the role operator');
  assert.equal(await button(vi, 'Force stir').getAttribute('title'), 'needs the role engineer');
  await vi.getByText('You are a viewer').waitFor();
  assert.equal(await button(vi, 'Log').isEnabled(), false);
  assert.equal(await button(vi, 'Users').count(), 0);
  assert.deepEqual(await axe(vi), [], 'a viewer');

  // An operator may start; the old session ends with the new role.
  await button(ana, 'Users').click();
  await users.getByLabel('Role of vi').selectOption({ label: 'operator' });
  await vi.getByRole('heading', { name: 'Log in' }).waitFor();
  await login(vi, 'vi');
  await button(vi, 'Start').click();
  await vi.locator('.mode.run').waitFor();
  await ana.locator('.mode.run').waitFor();

  // The admin ends the session.
  await button(ana, 'Close').click();
  await button(ana, 'Users').click();
  await button(ana, 'End sessions: vi').click();
  await vi.getByRole('heading', { name: 'Log in' }).waitFor();
  await button(ana, 'Remove vi').click();
  await button(ana, 'Press again to remove vi').click();
  await users.getByLabel('Role of vi').waitFor({ state: 'detached' });
  await login(vi, 'vi');
  await vi.getByRole('alert').getByText('name or password is wrong').waitFor();
  await button(ana, 'Close').click();

  // The deeds of everyone.
  await button(ana, 'Log').click();
  const log = ana.getByRole('dialog', { name: 'Log' });
  await log.getByText('started').first().waitFor();
  await fits(ana);
  assert.deepEqual(await axe(ana), [], 'the log on a phone');
  await ana.setViewportSize({ width: 1280, height: 800 });
  await log.getByLabel('Level').selectOption({ label: 'deed of a person' });
  await log.getByText('started').first().waitFor({ state: 'detached' });
  const text = await log.locator('table').innerText();
  for (const deed of [/vi · 127\.0\.0\.1\s+run/, /ana · 127\.0\.0\.1\s+user-role · role: operator, user: vi/, /user-revoke/, /user-remove/]) assert.match(text, deed);
  await log.getByLabel('Text').fill('user-add');
  await button(ana, 'Find').click();
  await log.getByText('user-remove').waitFor({ state: 'detached' });
  // The one with the short password was refused, and stands there as well.
  assert.equal(await log.locator('tbody tr').count(), 3);
  assert.deepEqual(await axe(ana), [], 'the log');
  await button(ana, 'Close').click();
  await log.waitFor({ state: 'detached' });
  for (const [language, word] of [['Français', 'Se déconnecter'], ['Português', 'Terminar sessão'], ['English', 'Log out']] as const) {
    await speak(ana, language);
    await button(ana, word).waitFor();
  }
  await button(ana, 'Log out').click();
  await ana.getByRole('heading', { name: 'Log in' }).waitFor();
  await Promise.all([ana, vi].map((page) => page.context().close()));
});

for (const [name, size] of [['upright', UPRIGHT], ['lying', LYING]] as const) {
  test(`a finger logs in, and reaches users and log, ${name}`, async () => {
    const own = await Machine.guarded();
    try {
      const at = { url: own.machine.url, stop: async () => undefined };
      const hand = await telephone(b, at, undefined, size);
      const { page } = hand;
      await page.getByRole('heading', { name: 'The first admin' }).waitFor();
      assert.deepEqual(await hand.unfit(), [], 'the first admin');
      for (const [label, text] of [['Code', own.code], ['Name', 'ana'], ['New password', PASSWORD], ['The password once more', PASSWORD]] as const) await page.getByLabel(label, { exact: label === 'Name' }).fill(text);
      await hand.press('Become the first admin');
      await page.locator('.mode.stop').waitFor();
      assert.deepEqual(await hand.unfit(), [], 'an admin');
      for (const dialog of ['Users', 'Log']) {
        await hand.press(dialog);
        await page.getByRole('dialog', { name: dialog }).waitFor();
        assert.deepEqual(await hand.unfit(), [], dialog);
        await hand.press('Close');
      }
      await page.context().close();
      const next = await telephone(b, at, undefined, size);
      await next.page.getByRole('heading', { name: 'Log in' }).waitFor();
      assert.deepEqual(await next.unfit(), [], 'the login');
      await next.page.context().close();
    } finally {
      await own.machine.done();
    }
  });
}
