// A small window at a place of the text; one at a time.
import { StateEffect, StateField } from '@codemirror/state';
import { showTooltip, type EditorView, type Tooltip } from '@codemirror/view';

export const open = StateEffect.define<Tooltip | null>();

export const smallWindow = StateField.define<Tooltip | null>({
  create: () => null,
  update(tooltip, transaction) {
    for (const effect of transaction.effects) if (effect.is(open)) return effect.value;
    return transaction.docChanged || transaction.selection ? null : tooltip;
  },
  provide: (field) => showTooltip.from(field),
});

export function shut(view: EditorView): void {
  view.dispatch({ effects: open.of(null) });
  view.focus();
}

export function leaving(view: EditorView, dom: HTMLElement): void {
  dom.addEventListener('focusout', (e) => {
    if (dom.contains(e.relatedTarget as Node | null)) return;
    // The focus also leaves when the window is removed during an update, so the dispatch is
    // delayed.
    setTimeout(() => dom.isConnected && view.dispatch({ effects: open.of(null) }));
  });
  dom.addEventListener('keydown', (e) => {
    if (e.key !== 'Escape') return;
    e.preventDefault();
    e.stopPropagation();
    shut(view);
  });
}

/** Shows a message at a place until the cursor moves away. */
export function tell(view: EditorView, pos: number, dom: HTMLElement): void {
  dom.className = 'g7-hover';
  dom.tabIndex = 0;
  leaving(view, dom);
  view.dispatch({ effects: open.of({ pos, above: false, create: () => ({ dom }) }) });
  setTimeout(() => dom.focus());
}
