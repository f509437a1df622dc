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
    await act(page, 'machine', 'Unplug');
    await alarms(operator).getByText('unit does not answer').waitFor();
    await tilt.getByText('substituted').waitFor();
    await tilt.locator('output', { hasText: 'FALSE' }).waitFor();
    await act(page, 'machine', 'Plug in');
    await alarms(operator).getByText('unit answers').nth(1).waitFor();
    await act(page, 'machine', 'Freeze');
    await alarms(operator).getByText('unit does not answer').nth(1).waitFor();
    await act(page, 'machine', 'Let go on');
    await alarms(operator).getByText('unit answers').nth(2).waitFor();
    await page.locator('#log').getByText('unit does not answer').first().waitFor();
    if ((await part(page, 'broker').locator('.state').innerText()) !== 'not installed') {
      await page.locator('#log').getByText('sorter/status online').first().waitFor();
      await act(page, 'broker', 'Kill');
      await alarms(operator).getByText('broker does not answer').waitFor();
      await operator.locator('.mode.run').waitFor();
      await act(page, 'broker', 'Plug in');
      await alarms(operator).getByText('broker answers').nth(1).waitFor();
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
