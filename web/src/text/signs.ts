// Signs that are not on the keyboard: `\up` becomes ↑ as soon as it is complete.
import { EditorView } from '@codemirror/view';
import type { Key } from '../lib/i18n';

export interface Sign {
  show: string;
  put: string;
  name: Key;
  /** The word typed after a backslash. */
  word: string;
}

export const signs: Sign[] = [
  { show: '↑', put: '↑', name: 'field.rise', word: 'up' },
  { show: '↓', put: '↓', name: 'field.fall', word: 'down' },
  { show: '·', put: '·', name: 'field.andSign', word: 'and' },
  { show: 'a̅', put: '\u0305', name: 'text.sign.bar', word: 'bar' },
  { show: '→', put: '→', name: 'text.sign.to', word: 'to' },
  { show: '≠', put: '≠', name: 'text.sign.ne', word: 'ne' },
  { show: '≤', put: '≤', name: 'text.sign.le', word: 'le' },
  { show: '≥', put: '≥', name: 'text.sign.ge', word: 'ge' },
];

export const writeSigns = EditorView.inputHandler.of((view, from, to, text) => {
  if (!/^[a-z]$/.test(text)) return false;
  const before = view.state.doc.sliceString(Math.max(0, from - 5), from);
  const word = /\\([a-z]*)$/.exec(before)?.[1];
  if (word === undefined) return false;
  const sign = signs.find((s) => s.word === word + text);
  if (!sign) return false;
  const start = from - word.length - 1;
  view.dispatch({
    changes: { from: start, to, insert: sign.put },
    selection: { anchor: start + sign.put.length },
    userEvent: 'input.type',
  });
  return true;
});
