// A picture of a page for the book.
import assert from 'node:assert/strict';
import { statSync } from 'node:fs';
import type { Page } from 'playwright-core';

export async function take(page: Page, path: string, most: number): Promise<void> {
  for (const quality of [85, 80, 72, 64, 56]) {
    await page.screenshot({ path, type: 'jpeg', quality, animations: 'disabled', caret: 'hide' });
    if (statSync(path).size <= most) return;
  }
  assert.fail(`${path} is larger than ${most} bytes`);
}
