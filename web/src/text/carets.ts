// Shows the carets and selections of the other people at the file, with their names, and tells them this page's own.
import { StateEffect, StateField, type Range } from '@codemirror/state';
import { Decoration, EditorView, WidgetType, type DecorationSet } from '@codemirror/view';
import type { OpenFile } from '../lib/files.svelte';
import { places } from '../together/places.svelte';

/** Somebody in the text: from the begin of the selection to the caret, in units. */
export interface Caret {
  name: string;
  colour: string;
  from: number;
  to: number;
}

export const carets = StateEffect.define<readonly Caret[]>();

class Named extends WidgetType {
  constructor(
    readonly name: string,
    readonly colour: string,
  ) {
    super();
  }

  override eq(other: Named): boolean {
    return other.name === this.name && other.colour === this.colour;
  }

  override toDOM(): HTMLElement {
    const caret = document.createElement('span');
    caret.className = 'cm-person';
    caret.style.setProperty('--colour', this.colour);
    caret.setAttribute('aria-hidden', 'true');
    const name = document.createElement('span');
    name.textContent = this.name;
    // A caret has no width, so that the letters stay where they are.
    caret.append(name);
    return caret;
  }

  override ignoreEvent(): boolean {
    return true;
  }
}

function drawn(all: readonly Caret[], length: number): DecorationSet {
  const found: Range<Decoration>[] = [];
  for (const { name, colour, from, to } of all) {
    const [a, b] = [Math.min(from, to, length), Math.min(Math.max(from, to), length)];
    if (a < b) found.push(Decoration.mark({ attributes: { style: `background: color-mix(in srgb, ${colour} 25%, transparent)` } }).range(a, b));
    found.push(Decoration.widget({ widget: new Named(name, colour), side: 1 }).range(Math.min(to, length)));
  }
  return Decoration.set(found, true);
}

const shown = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(value, transaction) {
    let now = value.map(transaction.changes);
    for (const effect of transaction.effects) if (effect.is(carets)) now = drawn(effect.value, transaction.newDoc.length);
    return now;
  },
  provide: (field) => EditorView.decorations.from(field),
});

const look = EditorView.baseTheme({
  '.cm-person': { position: 'relative', borderLeft: '2px solid var(--colour)', marginLeft: '-1px', marginRight: '-1px' },
  '.cm-person > span': {
    position: 'absolute',
    left: '-1px',
    top: '-1.15em',
    zIndex: 5,
    padding: '0 4px',
    color: '#fff',
    background: 'var(--colour)',
    borderRadius: '3px 3px 3px 0',
    font: '600 10px/1.25 system-ui, sans-serif',
    whiteSpace: 'nowrap',
    pointerEvents: 'none',
  },
});

/** Shows the others in the text of a file, and tells them of the selection here. */
export function people(file: OpenFile) {
  const tell = EditorView.updateListener.of(({ state, selectionSet, docChanged, view }) => {
    if (!selectionSet && !(docChanged && view.hasFocus)) return;
    const { anchor, head } = state.selection.main;
    places.tell(file, { text: [anchor, head] });
  });
  return [shown, look, tell];
}
