// The book's page on a kind of problem, in the language of the page. The pages of a language are fetched when the
// first of them is asked for.
import type { Language } from '../lib/i18n';
import { Refused } from '../lib/page';
import { prefs } from '../lib/prefs.svelte';

const books: Record<Language, () => Promise<{ pages: Record<string, string> }>> = {
  en: () => import('./problems/en'),
  fr: () => import('./problems/fr'),
  pt: () => import('./problems/pt'),
};

export async function explanation(code: string): Promise<{ language: Language; markdown: string }> {
  for (const language of new Set([prefs.language, 'en' as const])) {
    const { pages } = await books[language]();
    const own = Object.entries(pages).find(([path]) => path.endsWith(`/${code}.md`));
    if (own) return { language, markdown: own[1] };
  }
  throw new Refused(code);
}
