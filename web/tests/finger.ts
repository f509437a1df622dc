// Fingers for the tests: touches as the browser gets them from a screen, one or two at a time.
import type { Browser, CDPSession, Locator, Page } from 'playwright-core';
import { box, core, drawn, type Site } from './lib';

export const UPRIGHT = { width: 390, height: 844 };
export const LYING = { width: 844, height: 390 };

/** So long a finger rests at the end of a drag, in ms. */
const REST = 200;

type Place = readonly [x: number, y: number];

/** A page on a telephone, with the settings of its user; errors in it make the test fail at its end. */
export async function telephone(b: Browser, site: Site, file?: string, size = UPRIGHT, prefs: object = {}): Promise<Hand> {
  const context = await b.newContext({ viewport: size, hasTouch: true, isMobile: true, locale: 'en-GB', ignoreHTTPSErrors: true });
  const kept = JSON.stringify({ language: 'en', ...prefs });
  await context.addInitScript((text) => location.protocol === 'http:' && (localStorage.getItem('g7-prefs') ?? localStorage.setItem('g7-prefs', text)), kept);
  const page = await context.newPage();
  const url = new URL(site.url);
  if (file) url.searchParams.set('file', file);
  await page.goto(url.href);
  if (file) await page.waitForSelector('.sheet [data-id]', { state: 'attached' });
  return new Hand(page, await context.newCDPSession(page));
}

export class Hand {
  constructor(
    readonly page: Page,
    readonly screen: CDPSession,
  ) {}

  #touch(type: 'touchStart' | 'touchMove' | 'touchEnd', ...at: Place[]): Promise<unknown> {
    return this.screen.send('Input.dispatchTouchEvent', { type, touchPoints: at.map(([x, y], id) => ({ x, y, id })) });
  }

  async tap(at: Place): Promise<void> {
    await this.page.touchscreen.tap(...at);
  }

  /** Taps a button of this name. */
  async press(name: string | RegExp): Promise<void> {
    await this.page.getByRole('button', { name, exact: true }).tap();
  }

  /** Taps a symbol, which is selected then. */
  async choose(id: string): Promise<void> {
    await this.tap(await core(this.page, id));
    await this.page.locator('.marks .selected').first().waitFor({ state: 'attached' });
  }

  /** Two taps, with the times of a quick finger however slow the machine is. */
  async tapTwice([x, y]: Place): Promise<void> {
    const begun = Date.now() / 1000;
    const events = [0, 0.05, 0.15, 0.2].map((after, n) => ({
      type: n % 2 === 0 ? ('touchStart' as const) : ('touchEnd' as const),
      touchPoints: n % 2 === 0 ? [{ x, y, id: 0 }] : [],
      timestamp: begun + after,
    }));
    await Promise.all(events.map((event) => this.screen.send('Input.dispatchTouchEvent', event)));
  }

  /** Two places that move from here to there, or one. The fingers rest before they leave: after a flick, Chromium takes the
   * next tap as the end of a fling and sends no click. */
  async slide(from: Place[], to: Place[]): Promise<void> {
    await this.#touch('touchStart', ...from);
    for (let n = 1; n <= 8; n++) {
      await this.#touch('touchMove', ...from.map(([x, y], i): Place => [x + (((to[i]?.[0] ?? x) - x) * n) / 8, y + (((to[i]?.[1] ?? y) - y) * n) / 8]));
    }
    await new Promise((done) => setTimeout(done, REST));
    await this.#touch('touchMove', ...to);
    await this.#touch('touchEnd');
    await drawn(this.page);
  }

  /** Presses a place until something is seen. */
  async hold(at: Place, seen: Locator): Promise<void> {
    await this.#touch('touchStart', at);
    await seen.waitFor();
    await this.#touch('touchEnd');
  }

  /** The controls that lie beyond the window, or are smaller than a finger needs. Tables and texts scroll with what is in them. */
  unfit(): Promise<string[]> {
    return this.page.evaluate(() => {
      const found: string[] = [];
      for (const e of document.querySelectorAll<HTMLElement>('button, input, select, textarea, a[href], summary, [role=tab]')) {
        if (!e.checkVisibility({ visibilityProperty: true }) || e.closest('.cm-editor, [aria-hidden=true]') || e.matches('.handle, .skip')) continue;
        const own = e.getBoundingClientRect();
        const label = e.closest('label')?.getBoundingClientRect() ?? own;
        const name = e.getAttribute('aria-label') ?? e.textContent?.trim() ?? '';
        const [wide, high] = [Math.max(own.width, label.width), Math.max(own.height, label.height)];
        if (wide < 39.5 || high < 39.5) found.push(`${name} is ${Math.round(wide)} × ${Math.round(high)} px`);
        if (!e.closest('table, .table, .palette') && (own.left < -0.5 || own.right > innerWidth + 0.5)) found.push(`${name} ends at ${Math.round(own.right)} px`);
      }
      return found;
    });
  }

  /** The middle of what is seen. */
  async middle(of: Locator): Promise<Place> {
    const at = await box(of);
    return [at.x + at.width / 2, at.y + at.height / 2];
  }
}
