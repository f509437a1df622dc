// The sheets of the print preview: what is printed, on which paper, and the pages that the program makes of it.
import { files, type OpenFile } from '../lib/files.svelte';
import { said } from '../lib/i18n';
import { SHEET } from '../lib/ids';
import { page } from '../lib/page';
import { prefs } from '../lib/prefs.svelte';
import { proofs } from '../lib/proofs.svelte';
import type { Printed, SheetsAnswer, Shelved } from '../lib/protocol';
import { readPicture } from '../share/parcels';

export type What = 'chart' | 'charts' | 'dossier';

/** The class of the element that holds the sheets while the browser prints. */
export const HOST = 'print-sheets';

class Sheets {
  what: What = $state('chart');
  title = $state('');
  revision = $state('');
  date = $state(new Date().toISOString().slice(0, 10));
  made: Printed | null = $state.raw(null);
  /** The sheet that is shown, from 0. */
  at = $state(0);
  failed = $state('');
  #turn = 0;

  /** Makes the sheets anew; `chart` is the visible one. */
  async make(file: OpenFile, chart: string): Promise<void> {
    const turn = ++this.#turn;
    const dossier = this.what === 'dossier';
    const wish = {
      paper: prefs.paper,
      charts: this.what === 'chart' && chart !== SHEET ? [chart] : file.look.charts.map((c) => c.name),
      dossier,
      head: { title: this.title, author: prefs.author, company: prefs.company, revision: this.revision, date: this.date },
      answers: dossier ? answers() : undefined,
    };
    await file.settled();
    try {
      const pictures = dossier ? await picturesOf(file) : [];
      const made = await page.call({ do: 'sheets', file: file.name, ...wish, pictures });
      if (turn !== this.#turn) return;
      this.made = made;
      this.failed = '';
      this.at = Math.min(this.at, made.pages.length - 1);
    } catch (error) {
      if (turn !== this.#turn) return;
      this.made = null;
      this.failed = (error as Error).message;
    }
  }

  /** Forgets the sheets. */
  drop(): void {
    this.#turn++;
    this.made = null;
    this.at = 0;
  }

  /** Goes to another sheet. */
  turn(by: number): void {
    this.at = Math.max(0, Math.min((this.made?.pages.length ?? 1) - 1, this.at + by));
  }
}

/** The answers of the panel *Prove* about the present text, in the language of the page. */
function answers(): SheetsAnswer[] | undefined {
  return proofs.present?.rows.map((r) => ({ claim: said(r.claim), verdict: r.verdict, reason: said(r.reason), help: said(r.help), line: r.line, own: r.own }));
}

async function picturesOf(file: OpenFile): Promise<Shelved[]> {
  const read = async (name: string): Promise<Shelved> => {
    const text = await readPicture(file.name, name).catch(() => null);
    return text === null ? { file: name } : { file: name, text };
  };
  return Promise.all(file.look.pictures.map(read));
}

export const sheets = new Sheets();

/** Shows SVG in a tree of its own, so that its style is not that of the page. */
export function shown(host: HTMLElement, html: string): { update(html: string): void } {
  const root = host.shadowRoot ?? host.attachShadow({ mode: 'open' });
  const set = (text: string) => (root.innerHTML = text);
  set(html);
  return { update: set };
}

/** While the preview is open the browser prints its sheets, a page for each. */
export function printed(): () => void {
  let host: HTMLElement | null = null;
  let size: HTMLStyleElement | null = null;
  const after = () => {
    host?.remove();
    size?.remove();
    host = size = null;
  };
  const before = () => {
    after();
    const made = sheets.made;
    if (!made) return;
    const { width, height, pages } = made;
    host = document.createElement('div');
    host.className = HOST;
    const style = `:host{display:block}.sheet{width:${width}mm;height:${height}mm;overflow:hidden;break-after:page}.sheet:last-child{break-after:auto}svg{display:block;width:100%;height:100%}`;
    shown(host, `<style>${style}</style>${pages.map((svg) => `<div class="sheet">${svg}</div>`).join('')}`);
    size = document.createElement('style');
    size.textContent = `@page{size:${width}mm ${height}mm;margin:0}`;
    document.head.append(size);
    document.body.append(host);
  };
  window.addEventListener('beforeprint', before);
  window.addEventListener('afterprint', after);
  return () => {
    window.removeEventListener('beforeprint', before);
    window.removeEventListener('afterprint', after);
    after();
  };
}

/** The file whose sheets are shown. */
export const subject = (): OpenFile | null => files.current;
