// The book's page on a kind of problem, in the language of the page. The module of wasm has those in English;
// those in the other languages are fetched when the first of them is asked for.
import type { Language } from '../lib/i18n';
import { page } from '../lib/page';
import { prefs } from '../lib/prefs.svelte';

const others: Partial<Record<Language, () => Promise<{ pages: Record<string, string> }>>> = {
  fr: () => import('./problems/fr'),
  pt: () => import('./problems/pt'),
};

export async function explanation(code: string): Promise<{ language: Language; markdown: string }> {
  const { language } = prefs;
  const pages = (await others[language]?.())?.pages ?? {};
  const own = Object.entries(pages).find(([path]) => path.endsWith(`/${code}.md`));
  if (own) return { language, markdown: own[1] };
  const { markdown } = await page.call({ do: 'explain', code });
  return { language: 'en', markdown };
}
