// Keeps the text view and the open file equal: typed changes go to the file, other changes come
// back as splices. Undo belongs to the file.
import { Annotation, Transaction } from '@codemirror/state';
import { EditorView, type ViewUpdate } from '@codemirror/view';
import { asSpecs, asSplices, type OpenFile } from '../lib/files.svelte';
import type { Splice } from '../lib/protocol';
import { shell } from '../lib/shell.svelte';

/** Marks a change that came from the file and is not sent back. */
export const fromFile = Annotation.define<boolean>();
/** Marks a change that is undone as a unit, apart from typing before and after it. */
export const asUnit = Annotation.define<boolean>();

const UNITS = ['input.paste', 'input.drop', 'input.complete', 'delete.cut', 'move', 'input.replace'];

export function sync(file: OpenFile) {
  let sending = false;
  const send = EditorView.updateListener.of((update: ViewUpdate) => {
    for (const transaction of update.transactions) {
      if (!transaction.docChanged || transaction.annotation(fromFile)) continue;
      const unit = transaction.annotation(asUnit) === true || UNITS.some((event) => transaction.isUserEvent(event));
      sending = true;
      void shell.try(() => file.type(asSplices(transaction.changes), unit));
      sending = false;
    }
  });
  /** Applies changes made elsewhere until the returned function is called. */
  const follow = (view: EditorView): (() => void) =>
    file.listen(({ splices: changes, origin }) => {
      if (sending) return;
      view.dispatch({
        changes: asSpecs(changes),
        annotations: [fromFile.of(true), Transaction.addToHistory.of(false)],
        ...(origin === 'history' && changes[0] && view.hasFocus ? { selection: { anchor: after(changes) }, scrollIntoView: true } : {}),
      });
    });
  return { send, follow };
}

/** The end of the last change, in the text after it. */
function after(changes: Splice[]): number {
  let shift = 0;
  let at = 0;
  for (const { from, to, insert } of changes) {
    at = from + shift + insert.length;
    shift += insert.length - (to - from);
  }
  return at;
}
