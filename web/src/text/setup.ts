// The extensions that make up the text view of one file.
import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from '@codemirror/autocomplete';
import { defaultKeymap, indentWithTab } from '@codemirror/commands';
import { bracketMatching, codeFolding, foldGutter, foldKeymap, indentOnInput, indentUnit } from '@codemirror/language';
import { lintGutter, nextDiagnostic, previousDiagnostic } from '@codemirror/lint';
import { highlightSelectionMatches, search, searchKeymap } from '@codemirror/search';
import { EditorState, Prec, type Extension } from '@codemirror/state';
import { crosshairCursor, drawSelection, dropCursor, EditorView, type Command, highlightActiveLine, highlightActiveLineGutter, keymap, lineNumbers, rectangularSelection } from '@codemirror/view';
import type { OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { shell } from '../lib/shell.svelte';
import { completion, hover } from './ask';
import { byBraces } from './braces';
import { people } from './carets';
import { highlight } from './highlight';
import { marks } from './marks';
import { phrases } from './phrases';
import { writeSigns } from './signs';
import { definition, references, rename } from './small';
import { theme } from './theme';
import { smallWindow } from './window';

const language = {
  commentTokens: { line: '//', block: { open: '/*', close: '*/' } },
  closeBrackets: { brackets: ['(', '[', '{', '"', '`'] },
  indentOnInput: /^\s*[})]$/,
  wordChars: '_',
};

function history(file: OpenFile, way: 'undo' | 'redo') {
  return () => {
    void shell.try(() => (way === 'undo' ? file.undo() : file.redo()));
    return true;
  };
}

export function format(file: OpenFile): void {
  void shell.try(() => file.format());
}

/** Fixes the problem at the cursor if there is exactly one fix, and declares a name that is no slip as its use asks for;
 * otherwise the list of problems offers the choices. */
function mend(file: OpenFile): Command {
  return ({ state }) => {
    const at = state.selection.main.head;
    const here = file.look.problems.filter((p) => p.from <= at && at <= p.to && p.fixes.length > 0);
    const [only] = here;
    const plain = only && (only.fixes.length === 1 || (only.declares !== undefined && !only.fixes[0]?.splices));
    if (only && plain && here.length === 1) void shell.try(() => file.mend(only, 0));
    else shell.problems(at);
    return true;
  };
}

export function setup(file: OpenFile, more: Extension): Extension {
  const keys = [
    { key: 'Mod-z', run: history(file, 'undo'), shift: history(file, 'redo'), preventDefault: true },
    { key: 'Mod-y', run: history(file, 'redo'), preventDefault: true },
    { key: 'F2', run: rename(file) },
    { key: 'F12', run: definition(file), shift: references(file) },
    { key: 'F8', run: nextDiagnostic, shift: previousDiagnostic },
    { key: 'Mod-.', run: mend(file) },
    {
      key: 'Shift-Alt-f',
      run: () => {
        format(file);
        return true;
      },
    },
  ];
  const click = EditorView.domEventHandlers({
    click(e, view) {
      if (!(e.ctrlKey || e.metaKey) || e.button !== 0) return false;
      return definition(file)(view);
    },
  });
  return [
    // Line ends are `\n` alone, so that places equal those of the file.
    EditorState.lineSeparator.of('\n'),
    EditorView.clipboardInputFilter.of((text) => text.replace(/\r\n?/g, '\n')),
    EditorState.phrases.of(phrases()),
    EditorState.languageData.of(() => [language]),
    EditorState.allowMultipleSelections.of(true),
    indentUnit.of('  '),
    lintGutter(),
    lineNumbers(),
    codeFolding(),
    foldGutter(),
    highlightActiveLine(),
    highlightActiveLineGutter(),
    drawSelection(),
    dropCursor(),
    rectangularSelection(),
    crosshairCursor(),
    bracketMatching(),
    closeBrackets(),
    indentOnInput(),
    highlightSelectionMatches(),
    search({ top: true }),
    autocompletion({ override: [completion(file)], activateOnTypingDelay: 60, icons: false }),
    hover(file),
    byBraces,
    highlight(file),
    marks,
    smallWindow,
    writeSigns,
    people(file),
    EditorState.readOnly.of(file.locked !== null),
    click,
    theme,
    Prec.high(keymap.of(keys)),
    keymap.of([...closeBracketsKeymap, ...completionKeymap, ...searchKeymap, ...foldKeymap, ...defaultKeymap, indentWithTab]),
    EditorView.contentAttributes.of({ 'aria-label': t('text.of', { name: file.name }), tabindex: '0', spellcheck: 'false', autocorrect: 'off', autocapitalize: 'off' }),
    more,
  ];
}
