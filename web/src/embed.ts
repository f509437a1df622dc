// The element `<g7-chart>` for any page: `<script src="…/embed.js" defer></script>`. Its text is a chart, or `src` names a
// file with one; it becomes a frame with the editor, which runs and changes the chart. Attributes: `file` (the name of the
// file, by which an import is recognized), `src`, `view` (`chart`, `text`, `both`), `lang`, `theme`, `look`, `height` (CSS).
//
// The script stands alone: the page around it has another origin, so it can load no modules of this one.
import { packed } from './share/links';
import { share } from './lib/words/share';

/** The address of the editor: the folder of this script. */
const place = new URL('.', (document.currentScript as HTMLScriptElement).src);
const HEIGHT = '480px';

/** The text without the common indentation of its lines, and without empty lines around it. */
function plain(text: string): string {
  const lines = text.replace(/^(\s*\n)+/, '').trimEnd().split('\n');
  const indents = lines.filter((line) => line.trim() !== '').map((line) => line.length - line.trimStart().length);
  const indent = Math.min(...indents);
  return lines.map((line) => line.slice(Number.isFinite(indent) ? indent : 0)).join('\n') + '\n';
}

class ChartElement extends HTMLElement {
  static readonly observedAttributes = ['src', 'file', 'view', 'lang', 'theme', 'look', 'height'];
  #text = '';
  #shown = 0;

  connectedCallback(): void {
    // While the page is read, the text of the element is not there yet.
    if (document.readyState === 'loading') addEventListener('DOMContentLoaded', () => this.#begin(), { once: true });
    else this.#begin();
  }

  attributeChangedCallback(): void {
    if (this.shadowRoot) void this.#show();
  }

  #begin(): void {
    if (this.shadowRoot) return;
    // The chart in a script of the type text/plain needs no entities.
    this.#text = plain(this.querySelector('script')?.textContent ?? this.textContent ?? '');
    this.attachShadow({ mode: 'open' });
    void this.#show();
  }

  async #show(): Promise<void> {
    const number = ++this.#shown;
    const src = this.getAttribute('src');
    const file = this.getAttribute('file') ?? src?.split(/[?#]/)[0]?.split('/').pop() ?? 'chart.g7';
    let shown: HTMLElement;
    try {
      const text = src === null ? this.#text : await read(src);
      shown = this.#frame(await packed({ file, text, uses: [], pictures: [] }), file);
    } catch {
      shown = document.createElement('p');
      shown.textContent = share['share.unread'][this.lang === 'fr' ? 1 : this.lang === 'pt' ? 2 : 0].replace('{address}', src ?? file);
    }
    if (number === this.#shown) this.shadowRoot?.replaceChildren(shown);
  }

  #frame(hash: string, title: string): HTMLElement {
    const address = new URL(place);
    address.searchParams.set('embed', '');
    for (const name of ['view', 'lang', 'theme', 'look']) {
      const value = this.getAttribute(name);
      if (value !== null) address.searchParams.set(name, value);
    }
    const frame = document.createElement('iframe');
    frame.title = title;
    frame.loading = 'lazy';
    frame.src = address.href + hash;
    frame.style.cssText = 'display: block; width: 100%; border: 1px solid #ccc; border-radius: 6px';
    frame.style.height = this.getAttribute('height') ?? HEIGHT;
    return frame;
  }
}

async function read(src: string): Promise<string> {
  const answer = await fetch(new URL(src, document.baseURI));
  if (!answer.ok) throw new Error(String(answer.status));
  return answer.text();
}

if (!customElements.get('g7-chart')) customElements.define('g7-chart', ChartElement);
