// The book's page on a kind of problem, in the language of the page. The pages of a language are fetched when the
// first of them is asked for.
import { t, type Language } from '../lib/i18n';
import { link } from '../lib/link.svelte';
import { Refused } from '../lib/page';
import { prefs } from '../lib/prefs.svelte';

const books: Record<Language, () => Promise<{ pages: Record<string, string> }>> = {
  en: () => import('./problems/en'),
  fr: () => import('./problems/fr'),
  pt: () => import('./problems/pt'),
};

const here = new Set<Language>();

export async function explanation(code: string): Promise<{ language: Language; markdown: string }> {
  for (const language of new Set([prefs.language, 'en' as const])) {
    // A browser never asks again for a part that it could not get, so it is not asked in vain.
    if (!here.has(language) && link.state !== 'up') throw new Refused(t('gone.part'));
    const { pages } = await books[language]();
    here.add(language);
    const own = Object.entries(pages).find(([path]) => path.endsWith(`/${code}.md`));
    if (own) return { language, markdown: own[1] };
  }
  throw new Refused(code);
}
