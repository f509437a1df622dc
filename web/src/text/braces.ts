// The parts enclosed by braces, for folding and indentation. Notes, comments and strings are
// skipped.
import { foldService, indentService } from '@codemirror/language';
import { StateField, type EditorState, type Text } from '@codemirror/state';

/** For each opening brace the place of its closing brace. */
function pairs(doc: Text): Map<number, number> {
  const found = new Map<number, number>();
  const open: number[] = [];
  const text = doc.toString();
  const sign = /\/\/[^\n]*|\/\*|\(\*|"(?:\\.|[^"\\\n])*"|`(?:\\.|[^`\\\n])*`|[{}]/g;
  for (let m = sign.exec(text); m; m = sign.exec(text)) {
    if (m[0] === '{') open.push(m.index);
    else if (m[0] === '}') {
      const from = open.pop();
      if (from !== undefined) found.set(from, m.index);
    } else if (m[0] === '/*' || m[0] === '(*') {
      const end = text.indexOf(m[0] === '/*' ? '*/' : '*)', m.index + 2);
      if (end < 0) break;
      sign.lastIndex = end + 2;
    }
  }
  return found;
}

interface Lazy {
  doc: Text;
  pairs?: Map<number, number>;
}

const braces = StateField.define<Lazy>({
  create: (state) => ({ doc: state.doc }),
  update: (known, transaction) => (transaction.docChanged ? { doc: transaction.newDoc } : known),
});

function known(state: EditorState): Map<number, number> {
  const lazy = state.field(braces);
  return (lazy.pairs ??= pairs(lazy.doc));
}

const fold = foldService.of((state, from, to) => {
  const line = state.doc.sliceString(from, to);
  for (let at = line.length - 1; at >= 0; at--) {
    if (line[at] !== '{') continue;
    const end = known(state).get(from + at);
    return end !== undefined && end > to ? { from: from + at + 1, to: end } : null;
  }
  return null;
});

const indent = indentService.of((context, at) => {
  const line = context.lineAt(at);
  let before = context.state.doc.lineAt(at);
  if (line.from === before.from && before.number === 1) return 0;
  // The nearest line above that is not blank.
  let text = context.simulatedBreak !== null && context.simulatedBreak <= before.to && at >= context.simulatedBreak ? context.textAfterPos(before.from, -1) : '';
  if (text === '') {
    do {
      if (before.number === 1) return 0;
      before = context.state.doc.line(before.number - 1);
      text = before.text;
    } while (text.trim() === '');
  } else text = before.text.slice(0, at - before.from);
  const depth = /^\s*/.exec(text)?.[0].length ?? 0;
  const opens = /[{(]\s*(\/\/.*)?$/.test(text) ? context.unit : 0;
  const closes = /^\s*[})]/.test(context.textAfterPos(at)) ? context.unit : 0;
  return Math.max(0, depth + opens - closes);
});

export const byBraces = [braces, fold, indent];
