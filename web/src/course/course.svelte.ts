// The course: its chapters in the language of the page, the one that is read, and what the browser remembers of the reader.
import { untrack } from 'svelte';
import { files } from '../lib/files.svelte';
import { t, type Language } from '../lib/i18n';
import { embedded } from '../lib/embedded';
import { link } from '../lib/link.svelte';
import { Refused } from '../lib/page';
import { prefs } from '../lib/prefs.svelte';
import { shape } from '../lib/shape.svelte';
import { shell } from '../lib/shell.svelte';
import { openParcel } from '../share/parcels';
import { chartOf } from './charts';

export interface Chapter {
  /** The name of its folder in `course/`. */
  id: string;
  title: string;
  text: string;
}

const books: Record<Language, () => Promise<{ texts: Record<string, string> }>> = {
  en: () => import('./texts/en'),
  fr: () => import('./texts/fr'),
  pt: () => import('./texts/pt'),
};

const KEY = 'g7-course';

/** Marks that the browser keeps: the chapter that was read last, and the questions that were answered. */
interface Kept {
  last: string | null;
  answered: string[];
}

function stored(): Kept {
  const nothing: Kept = { last: null, answered: [] };
  if (embedded) return nothing;
  try {
    const found = JSON.parse(localStorage.getItem(KEY) ?? 'null') as Partial<Kept> | null;
    const answered = Array.isArray(found?.answered) ? found.answered.filter((id) => typeof id === 'string') : [];
    return { last: typeof found?.last === 'string' ? found.last : null, answered };
  } catch {
    return nothing;
  }
}

class Course {
  #kept: Kept = $state.raw(stored());
  /** The chapter that the reader shows. */
  chapter: string | null = $state(null);
  /** The files in which charts of the course were opened. */
  #opened = new Map<string, string>();
  #books = new Map<Language, Chapter[]>();
  /** The chapters in the language that was asked for last. */
  chapters: readonly Chapter[] = $state.raw([]);
  /** The reason why they cannot be had. */
  failed = $state('');

  readonly last: string | null = $derived(this.#kept.last);

  answered(id: string): boolean {
    return this.#kept.answered.includes(id);
  }

  /** Notes that the question of a chapter was answered. */
  answer(id: string): void {
    if (!this.answered(id)) this.#keep({ answered: [...this.#kept.answered, id] });
  }

  /** Fetches the chapters in a language. */
  async load(language: Language): Promise<void> {
    this.failed = '';
    try {
      const found = this.#books.get(language) ?? (await fetched(language));
      this.#books.set(language, found);
      // The reader may have chosen another language meanwhile.
      if (language === prefs.language) this.chapters = found;
    } catch (error) {
      this.failed = (error as Error).message;
    }
  }

  /** Shows a chapter. The editor beside it begins with the first chart of the chapter if nothing is open. */
  async read(chapter: Chapter): Promise<void> {
    this.chapter = chapter.id;
    this.#keep({ last: chapter.id });
    shell.reading = true;
    shell.gallery = false;
    if (!shape.phone && prefs.leftOpen) prefs.leftOpen = false;
    const first = /!\[[^\]]*\]\(([^)]+)\)/.exec(chapter.text)?.[1];
    if (files.current || !first) return;
    await this.open(chapter.id, first);
    shell.reading = true;
  }

  /** Opens a chart of a chapter, or shows it again with what the reader has made of it. */
  async open(chapter: string, href: string): Promise<void> {
    const key = `${chapter}/${href}`;
    const known = files.find(this.#opened.get(key) ?? '');
    if (known) files.current = known;
    else {
      await openParcel(await chartOf(chapter, href));
      if (files.current) this.#opened.set(key, files.current.name);
    }
    shell.gallery = false;
    if (shape.phone) {
      shell.reading = false;
      prefs.view = 'chart';
    } else if (prefs.view === 'text') prefs.view = 'both';
  }

  #keep(change: Partial<Kept>): void {
    this.#kept = { ...this.#kept, ...change };
    if (embedded) return;
    try {
      localStorage.setItem(KEY, JSON.stringify(this.#kept));
    } catch {
      // The course also works in a browser without storage.
    }
  }
}

async function fetched(language: Language): Promise<Chapter[]> {
  // A browser never asks again for a part that it could not get, so it is not asked in vain.
  if (untrack(() => link.state) !== 'up') throw new Refused(t('gone.part'));
  return ordered((await books[language]()).texts);
}

function ordered(texts: Record<string, string>): Chapter[] {
  const rows = Object.entries(texts).map(([path, text]) => ({ id: path.split('/').at(-2) ?? '', title: /^# (.*)/.exec(text)?.[1] ?? '', text }));
  return rows.sort((a, b) => (a.id < b.id ? -1 : 1));
}

export const course = new Course();
