// The keys of the drawing.
import { SHEET } from '../lib/ids';
import { shell } from '../lib/shell.svelte';
import { commandOf } from './commands';
import { editor } from './editor.svelte';

const WAYS = { ArrowUp: 'up', ArrowDown: 'down', ArrowLeft: 'left', ArrowRight: 'right' } as const;
const NUDGE = 10;

export function onKey(e: KeyboardEvent): void {
  if (handled(e)) {
    e.preventDefault();
    e.stopPropagation();
  }
}

function handled(e: KeyboardEvent): boolean {
  const ctrl = e.ctrlKey || e.metaKey;
  const way = WAYS[e.key as keyof typeof WAYS];
  if (way) return go(way, e, ctrl);
  if (e.key === 'Escape') return leave();
  if (e.key === 'ContextMenu' || (e.key === 'F10' && e.shiftKey)) return menu();
  if (ctrl && e.key.toLowerCase() === 'z') {
    void editor.history(e.shiftKey ? 'redo' : 'undo');
    return true;
  }
  if (ctrl && e.key.toLowerCase() === 'y') {
    void editor.history('redo');
    return true;
  }
  // Pasting is handled by an event of its own.
  if (ctrl && e.key.toLowerCase() === 'v') return false;
  if (!ctrl && (e.key === '+' || e.key === '-')) {
    editor.camera?.zoomBy(e.key === '+' ? 1.25 : 0.8);
    return true;
  }
  if (e.key === 'Backspace' && shell.selection.size === 0) return upward();
  if (e.key === 'Enter' && editor.one) {
    editor.enter(editor.one);
    return true;
  }
  const command = commandOf(e);
  if (!command) return false;
  void command.run();
  return true;
}

function go(way: 'up' | 'down' | 'left' | 'right', e: KeyboardEvent, ctrl: boolean): boolean {
  if (e.altKey) {
    const [dx, dy] = { up: [0, -1], down: [0, 1], left: [-1, 0], right: [1, 0] }[way] as [number, number];
    const ids = [...shell.selection];
    if (editor.one?.part === 'title' && editor.chart === SHEET) void editor.arrange(editor.one, dx * NUDGE, dy * NUDGE);
    else if (ids.length > 0) void editor.apply({ g: 'move', ids, dx: dx * NUDGE, dy: dy * NUDGE });
    return true;
  }
  if (ctrl) {
    const { x, y, k } = editor.view;
    const [dx, dy] = { up: [0, -80], down: [0, 80], left: [-80, 0], right: [80, 0] }[way] as [number, number];
    editor.camera?.moveTo((editor.width / 2 - x + dx) / k, (editor.height / 2 - y + dy) / k);
    return true;
  }
  const from = [...shell.selection].at(-1);
  const to = from ? editor.scene?.towards(from, way) : editor.scene?.ordered()[0]?.id;
  if (!to) return true;
  shell.select(e.shiftKey ? [...[...shell.selection].filter((s) => s !== to), to] : [to]);
  const item = editor.scene?.byId.get(to);
  if (item) editor.camera?.reveal(item.area);
  return true;
}

function leave(): boolean {
  if (editor.menu) editor.menu = null;
  else if (shell.selection.size > 0) shell.select([]);
  else return false;
  return true;
}

/** Opens the chart that contains this one. */
export function upward(): boolean {
  const { file, chart } = editor;
  const of = file?.look.charts.find((c) => c.name === chart)?.of;
  if (!file || !of) return false;
  shell.show(file, of[0]);
  return true;
}

function menu(): boolean {
  const box = editor.one?.area ?? [0, 0, 0, 0];
  const { x, y, k } = editor.view;
  editor.menu = editor.one
    ? { x: box[0] * k + x + 20, y: box[1] * k + y + 20 }
    : { x: editor.width / 2, y: editor.height / 2 };
  return true;
}
