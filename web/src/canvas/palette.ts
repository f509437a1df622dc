// Tools that can be dropped into the drawing: on a link they are inserted, near an open end they
// continue the sequence, elsewhere they stand free.
import type { Between } from '../lib/protocol';
import { shell } from '../lib/shell.svelte';
import { editor, type Tool } from './editor.svelte';

const REACH = 26;

export const tools: Tool[] = ['step', 'transition', 'macro', 'enclosing', 'or', 'and', 'action', 'comment'];

const intoLink: ReadonlySet<Tool> = new Set<Between>(['step', 'transition', 'macro', 'enclosing']);
const isInserted = (what: Tool): what is Between => intoLink.has(what);

/** The id of the symbol or link that a tool would affect at a place of the plane. */
export function targetOf(what: Tool, x: number, y: number): string | null {
  const scene = editor.scene;
  if (!scene) return null;
  const reach = REACH / Math.min(editor.view.k, 1);
  if (!isInserted(what)) {
    // A comment stands free unless it is dropped on a symbol.
    const over = scene.hit(x, y, reach);
    const wanted = what === 'or' || what === 'action' ? ['step'] : what === 'and' ? ['transition'] : ['step', 'transition', 'comment'];
    return over && wanted.includes(over.part) ? over.id : null;
  }
  return (scene.linkAt(x, y, reach) ?? scene.endAt(x, y, reach * 2))?.id ?? null;
}

/** Uses a tool on a symbol or link, or free at a place. */
export async function useTool(what: Tool, target: string | null, at?: [number, number]): Promise<void> {
  const item = target ? editor.scene?.byId.get(target) : undefined;
  const { chart } = editor;
  if (chart === null) return;
  if (item && what === 'action') editor.edit(item.id, 'action');
  else if (item && what === 'comment') editor.edit(item.id, 'comment');
  else if (what === 'comment') editor.note(at ?? editor.beside());
  else if (item && (what === 'or' || what === 'and')) await editor.apply({ g: 'branch', id: item.id, how: what });
  else if (item?.part === 'link' && isInserted(what)) await editor.apply({ g: 'insert', link: item.id, what });
  else if (item && isInserted(what)) {
    const made = await editor.apply({ g: 'next', id: item.id });
    await turn(what, made?.select ?? []);
  } else if (isInserted(what)) {
    const made = await editor.apply({ g: 'add_step', chart, ...(at ? { at } : {}) });
    await turn(what, made?.select ?? []);
  }
}

/** Changes a new step to the requested kind. */
async function turn(what: Tool, made: string[]): Promise<void> {
  if (what !== 'macro' && what !== 'enclosing') return;
  const step = made.find((id) => editor.scene?.byId.get(id)?.part === 'step');
  if (step) await editor.apply({ g: 'kind', id: step, kind: what });
}

/** A tool was released, possibly over the drawing. */
export function dropTool(root: HTMLElement, e: PointerEvent): void {
  const tool = editor.tool;
  if (!tool) return;
  editor.tool = null;
  const target = editor.target;
  editor.target = null;
  const box = root.getBoundingClientRect();
  const inside = e.clientX > box.left && e.clientX < box.right && e.clientY > box.top && e.clientY < box.bottom;
  if (!inside || !root.contains(document.elementFromPoint(e.clientX, e.clientY))) return;
  const [x, y] = editor.toPlane(e.clientX - box.left, e.clientY - box.top);
  const snap = (n: number) => Math.round(n / 5) * 5;
  void useTool(tool.what, target, [snap(x), snap(y)]);
  editor.camera?.focus();
}

/** A tool was pressed without being dragged: uses it at the selection. */
export function pressTool(what: Tool): void {
  const one = editor.one;
  void useTool(what, one?.id ?? null);
  if (what !== 'action' && what !== 'comment') editor.camera?.focus();
  if (!one && what === 'action') shell.select([]);
}
