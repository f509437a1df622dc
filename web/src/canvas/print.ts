// Printing: the whole chart on one page, without the rest of the page.
import { svgOf } from '../lib/redrawn';
import { shell } from '../lib/shell.svelte';
import { editor } from './editor.svelte';

/** Puts a complete picture into the document while the browser prints. */
export function keepPrintable(): () => void {
  let picture: HTMLElement | null = null;
  const before = () => {
    const drawing = editor.scene?.drawing;
    // The preview has sheets of its own.
    if (!drawing || shell.dialog === 'print') return;
    const [x, y, w, h] = drawing.area;
    picture = document.createElement('div');
    picture.className = 'printed';
    const title = document.createElement('h1');
    title.textContent = `${editor.file?.name ?? ''} — ${drawing.chart}`;
    picture.append(title);
    picture.insertAdjacentHTML(
      'beforeend',
      `<svg class="g7" width="${w + 20}" viewBox="${x - 10} ${y - 10} ${w + 20} ${h + 20}">${drawing.items.map(svgOf).join('')}</svg>`,
    );
    document.body.append(picture);
  };
  const after = () => {
    picture?.remove();
    picture = null;
  };
  window.addEventListener('beforeprint', before);
  window.addEventListener('afterprint', after);
  return () => {
    window.removeEventListener('beforeprint', before);
    window.removeEventListener('afterprint', after);
    after();
  };
}
