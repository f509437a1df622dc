// The bench of `make online-demo`: parts are unplugged and plugged, and the page of the operator tells it.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { axe, browser } from './lib';
import { bench } from './machine';

let b: Awaited<ReturnType<typeof browser>>;

before(async () => {
  b = await browser();
});

after(async () => {
  await b?.done();
});

const part = (page: Page, name: string) => page.locator(`#${name}`);
const act = (page: Page, name: string, word: string) => part(page, name).getByRole('button', { name: word, exact: true }).click();
const alarms = (page: Page) => page.getByRole('region', { name: 'Alarms and events', exact: true });

/** Does something and waits until the operator is told so once more. */
async function told(operator: Page, text: string, act: () => Promise<void>): Promise<void> {
  const all = alarms(operator).getByText(text);
  const before = await all.count();
  await act();
  await all.nth(before).waitFor();
}

test('each part of the bench is unplugged and plugged, and the operator sees it', async () => {
  const { url, end } = await bench();
  try {
    const context = await b.newContext({ viewport: { width: 1280, height: 800 } });
    const page = await context.newPage();
    await page.goto(url);
    await page.locator('#controller.plugged a').waitFor();
    assert.deepEqual(await axe(page), []);
    const popup = context.waitForEvent('page');
    await page.getByRole('link', { name: 'Page of the operator' }).click();
    const operator = await popup;
    await operator.locator('.mode.run').waitFor();
    await operator.getByRole('region', { name: 'Active steps' }).getByText('Sequencing').first().waitFor();
    await act(page, 'machine', 'Turn over');
    const tilt = operator.locator('.values li').filter({ has: operator.locator('b', { hasText: /^Tilt$/ }) });
    await tilt.locator('output', { hasText: 'TRUE' }).waitFor();
    await told(operator, 'unit does not answer', () => act(page, 'machine', 'Unplug'));
    await tilt.getByText('substituted').waitFor();
    await tilt.locator('output', { hasText: 'FALSE' }).waitFor();
    await told(operator, 'unit answers', () => act(page, 'machine', 'Plug in'));
    await told(operator, 'unit does not answer', () => act(page, 'machine', 'Freeze'));
    await told(operator, 'unit answers', () => act(page, 'machine', 'Let go on'));
    await page.locator('#log').getByText('unit does not answer').first().waitFor();
    if ((await part(page, 'broker').locator('.state').innerText()) !== 'not installed') {
      await page.locator('#log').getByText('sorter/status online').first().waitFor();
      const missed = page.locator('#log').getByText(/sorter\/events .*"device":"unit","kind":"down"/);
      await missed.nth(1).waitFor();
      const heard = await missed.count();
      await told(operator, 'broker does not answer', () => act(page, 'broker', 'Kill'));
      // The events from here on wait for the broker.
      await told(operator, 'unit does not answer', () => act(page, 'machine', 'Unplug'));
      await told(operator, 'unit answers', () => act(page, 'machine', 'Plug in'));
      await operator.locator('.mode.run').waitFor();
      await told(operator, 'broker answers', () => act(page, 'broker', 'Plug in'));
      await missed.nth(heard).waitFor();
    }
    await act(page, 'controller', 'Freeze');
    await operator.locator('.mode.gone').waitFor();
    await act(page, 'controller', 'Let go on');
    await operator.locator('.mode.fault').waitFor();
    await operator.getByRole('button', { name: 'Acknowledge', exact: true }).click();
    await operator.getByRole('button', { name: 'Start', exact: true }).click();
    await operator.locator('.mode.run').waitFor();
    await act(page, 'controller', 'Kill');
    await operator.locator('.mode.gone').waitFor();
    await page.locator('#controller.unplugged').waitFor();
    await act(page, 'controller', 'Plug in');
    await page.locator('#log').getByText('warm start').waitFor();
    // A form of another page reaches none of it.
    assert.equal((await fetch(`${url}unplug/machine`, { method: 'POST' })).status, 404);
    await context.close();
  } finally {
    await end();
  }
});
