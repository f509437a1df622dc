// Small windows at a name: to rename it, and to list the places where it is used.
import type { Command, EditorView } from '@codemirror/view';
import type { OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { shell } from '../lib/shell.svelte';
import { named, type Named } from './ask';
import { leaving, open, shut } from './window';

/** Makes a command that works on the name at the cursor. */
function atName(file: OpenFile, work: (view: EditorView, found: Named) => void): Command {
  return (view) => {
    const at = view.state.selection.main.head;
    void shell.try(async () => {
      const found = await named(file, view.state, at);
      if (!found) shell.say(t('text.noName'));
      else work(view, found);
    });
    return true;
  };
}

export const go = (view: EditorView, [from, to]: [number, number]): void => {
  view.dispatch({ selection: { anchor: from, head: to }, scrollIntoView: true, userEvent: 'select' });
  view.focus();
};

export const definition = (file: OpenFile): Command => atName(file, (view, found) => go(view, found.declared));

export const rename = (file: OpenFile): Command =>
  atName(file, (view, found) => {
    if (!found.id && !found.name) {
      shell.say(t('text.noRename', { name: found.word }));
      return;
    }
    const pos = view.state.selection.main.head;
    view.dispatch({ effects: open.of({ pos, above: false, create: () => ({ dom: renameForm(file, view, found) }) }) });
  });

function renameForm(file: OpenFile, view: EditorView, found: Named): HTMLElement {
  const form = document.createElement('form');
  form.className = 'g7-small';
  const field = document.createElement('input');
  field.className = 'cm-textfield';
  field.value = found.word.replace(/^`|`$/g, '');
  field.setAttribute('aria-label', t('text.renameTo', { name: field.value, n: found.places.length }));
  const button = document.createElement('button');
  button.className = 'cm-button';
  button.textContent = t('text.rename', { n: found.places.length });
  form.append(field, button);
  leaving(view, form);
  form.addEventListener('submit', (e) => {
    e.preventDefault();
    const to = field.value.trim();
    shut(view);
    if (to && to !== found.word) void shell.try(() => file.edit({ g: 'rename', to, ...(found.id ? { id: found.id } : { name: found.name ?? '' }) }));
  });
  setTimeout(() => field.select());
  return form;
}

export const references = (file: OpenFile): Command =>
  atName(file, (view, found) => {
    const pos = view.state.selection.main.head;
    view.dispatch({ effects: open.of({ pos, above: false, create: () => ({ dom: placeList(view, found) }) }) });
  });

function placeList(view: EditorView, found: Named): HTMLElement {
  const list = document.createElement('ul');
  list.className = 'g7-places';
  list.setAttribute('aria-label', t('text.places', { name: found.word, n: found.places.length }));
  for (const place of found.places) {
    const line = view.state.doc.lineAt(place[0]);
    const item = document.createElement('li');
    const button = document.createElement('button');
    const number = document.createElement('span');
    number.textContent = String(line.number);
    button.append(number, line.text.trim().slice(0, 90));
    button.addEventListener('click', () => go(view, place));
    item.append(button);
    list.append(item);
  }
  list.addEventListener('keydown', (e) => {
    const way = e.key === 'ArrowDown' ? 1 : e.key === 'ArrowUp' ? -1 : 0;
    if (way === 0) return;
    const buttons = [...list.querySelectorAll('button')];
    buttons[buttons.indexOf(document.activeElement as HTMLButtonElement) + way]?.focus();
    e.preventDefault();
  });
  leaving(view, list);
  setTimeout(() => list.querySelector('button')?.focus());
  return list;
}
