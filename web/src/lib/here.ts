// The name of this window, by which unsaved work belongs to it. It is the same after the page was loaded again, and
// another one in a copy of the tab: while the page is there the browser does not hold the name.
const KEY = 'g7-window';

function made(): string {
  return [...crypto.getRandomValues(new Uint8Array(12))].map((byte) => byte.toString(16).padStart(2, '0')).join('');
}

function taken(): string {
  try {
    const name = sessionStorage.getItem(KEY);
    sessionStorage.removeItem(KEY);
    return name ?? made();
  } catch {
    return made();
  }
}

export const here = taken();

addEventListener('pagehide', () => {
  try {
    sessionStorage.setItem(KEY, here);
  } catch {
    // Without storage the window has a new name when it comes again.
  }
});
addEventListener('pageshow', (event) => {
  if (event.persisted) sessionStorage.removeItem(KEY);
});

/** The names of the windows of this browser that are there, apart from this one. */
export async function others(): Promise<Set<string>> {
  const held = (await navigator.locks?.query().catch(() => undefined))?.held ?? [];
  const names = held.map((lock) => lock.name ?? '').filter((name) => name.startsWith(`${KEY}:`));
  return new Set(names.map((name) => name.slice(KEY.length + 1)).filter((name) => name !== here));
}

// The lock ends with the page, however that ends. Browsers have none on pages that are not protected, and refuse them in
// some frames.
navigator.locks?.request(`${KEY}:${here}`, () => new Promise(() => undefined)).catch(() => undefined);
