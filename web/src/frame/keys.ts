// Shortcuts that work everywhere. The drawing and the text view have their own.
import { files } from '../lib/files.svelte';
import { shell } from '../lib/shell.svelte';
import { save } from './actions';

/** True if keys go into a text field. */
export function typing(e: Event): boolean {
  const at = e.target as HTMLElement | null;
  return !!at?.closest('input, textarea, select, [contenteditable], .cm-editor');
}

export function onKey(e: KeyboardEvent): void {
  const file = files.current;
  const ctrl = e.ctrlKey || e.metaKey;
  const key = e.key.toLowerCase();
  if (e.key === '?' && !typing(e)) {
    shell.dialog = 'help';
  } else if (ctrl && key === 's') {
    if (file) void save(file);
  } else if (ctrl && key === 'p' && !e.shiftKey && file && shell.dialog !== 'print') {
    // In the preview it is the browser's own key, which prints the sheets.
    shell.dialog = 'print';
  } else if (ctrl && key === 'm' && e.shiftKey) {
    shell.problems();
  } else if (ctrl && key === 'f' && e.shiftKey) {
    shell.dialog = 'search';
  } else if (ctrl && key === 'f' && !typing(e)) {
    shell.dialog = 'search';
  } else if (ctrl && key === 'z' && !typing(e)) {
    if (file) void shell.try(() => (e.shiftKey ? file.redo() : file.undo()));
  } else if (ctrl && key === 'y' && !typing(e)) {
    if (file) void shell.try(() => file.redo());
  } else return;
  e.preventDefault();
}
