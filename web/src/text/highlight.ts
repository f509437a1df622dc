// Colours of the visible words, from the lexer of the Rust crates. While an answer is on its way,
// the present colours move with the text.
import { StateEffect, StateField, type Range } from '@codemirror/state';
import { Decoration, EditorView, ViewPlugin, type DecorationSet, type ViewUpdate } from '@codemirror/view';
import type { OpenFile } from '../lib/files.svelte';
import { page } from '../lib/page';

type Token = [from: number, to: number, kind: string];

/** Number of characters beyond the visible text that are coloured too. */
const MARGIN = 3000;
const PAUSE = 30;

const marks = new Map<string, Decoration>();
function mark(kind: string): Decoration {
  let known = marks.get(kind);
  if (!known) marks.set(kind, (known = Decoration.mark({ class: `tok-${kind}` })));
  return known;
}

const coloured = StateEffect.define<{ from: number; to: number; tokens: Token[] }>();

const colours = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(set, transaction) {
    set = set.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(coloured)) continue;
      const { from, to, tokens } = effect.value;
      const add: Range<Decoration>[] = tokens.filter(([a, b]) => a < b && b <= transaction.newDoc.length).map(([a, b, kind]) => mark(kind).range(a, b));
      set = set.update({ filter: (a, b) => b < from || a > to, add, sort: true });
    }
    return set;
  },
  provide: (field) => EditorView.decorations.from(field),
});

export function highlight(file: OpenFile) {
  const asker = ViewPlugin.fromClass(
    class {
      #timer: ReturnType<typeof setTimeout> | undefined;
      #gone = false;
      #busy = false;
      #again = false;

      constructor(readonly view: EditorView) {
        this.soon(0);
      }

      update(update: ViewUpdate): void {
        if (update.docChanged || update.viewportChanged) this.soon(PAUSE);
      }

      soon(pause: number): void {
        clearTimeout(this.#timer);
        this.#timer = setTimeout(() => void this.ask(), pause);
      }

      async ask(): Promise<void> {
        this.#again = this.#busy;
        if (this.#busy) return;
        this.#busy = true;
        try {
          await file.settled();
          if (this.#gone) return;
          const { doc } = this.view.state;
          const { viewport } = this.view;
          const from = Math.max(0, viewport.from - MARGIN);
          const to = Math.min(doc.length, viewport.to + MARGIN);
          const tokens = await page.call({ do: 'tokens', file: file.name, from, to });
          if (this.#gone) return;
          if (this.view.state.doc === doc) this.view.dispatch({ effects: coloured.of({ from, to, tokens }) });
          else this.soon(PAUSE);
        } catch {
          // The file was closed meanwhile.
        } finally {
          this.#busy = false;
          if (this.#again && !this.#gone) this.soon(0);
        }
      }

      destroy(): void {
        this.#gone = true;
        clearTimeout(this.#timer);
      }
    },
  );
  return [colours, asker];
}
