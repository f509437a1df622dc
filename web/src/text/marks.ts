// Marks in the text: the selection of the drawing, the active steps of a run, and the other places
// of the name at the cursor.
import { StateEffect, StateField, type Range } from '@codemirror/state';
import { Decoration, EditorView, type DecorationSet } from '@codemirror/view';

export type Span = [from: number, to: number];

export const pick = StateEffect.define<Span[]>();
export const light = StateEffect.define<Span[]>();
export const same = StateEffect.define<Span[]>();

const line = (name: string) => Decoration.line({ class: name });
const picked = line('cm-picked');
const live = line('cm-live');
const alike = Decoration.mark({ class: 'cm-same' });

/** Marks whole lines of spans. */
function lines(effect: typeof pick, mark: Decoration) {
  return StateField.define<DecorationSet>({
    create: () => Decoration.none,
    update(set, transaction) {
      set = set.map(transaction.changes);
      for (const e of transaction.effects) {
        if (!e.is(effect)) continue;
        const doc = transaction.newDoc;
        const starts = new Set<number>();
        for (const [from, to] of e.value) {
          for (let at = Math.min(from, doc.length); at <= Math.min(to, doc.length); ) {
            const row = doc.lineAt(at);
            starts.add(row.from);
            at = row.to + 1;
          }
        }
        set = Decoration.set([...starts].sort((a, b) => a - b).map((at) => mark.range(at)));
      }
      return set;
    },
    provide: (field) => EditorView.decorations.from(field),
  });
}

const words = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(set, transaction) {
    set = set.map(transaction.changes);
    for (const e of transaction.effects) {
      if (!e.is(same)) continue;
      const end = transaction.newDoc.length;
      const found: Range<Decoration>[] = e.value.filter(([from, to]) => from < to && to <= end).map(([from, to]) => alike.range(from, to));
      set = Decoration.set(found, true);
    }
    return set;
  },
  provide: (field) => EditorView.decorations.from(field),
});

export const marks = [lines(pick, picked), lines(light, live), words];
