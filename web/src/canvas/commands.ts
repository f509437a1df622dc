// All commands of the drawing. The keys, the context menu, the buttons at a selected symbol and the
// list of shortcuts all use this table.
import type { IconName } from '../lib/Icon.svelte';
import { t, type Key } from '../lib/i18n';
import { SHEET } from '../lib/ids';
import { runs } from '../lib/runs.svelte';
import { shell } from '../lib/shell.svelte';
import { why } from '../run/why.svelte';
import { editor } from './editor.svelte';

export interface Command {
  id: string;
  title: Key;
  /** Its title for the present selection, where that says more. */
  name?: () => string;
  /** The keys as shown to the user; the first one is compared with the pressed key. */
  keys?: string[];
  icon?: IconName | 'or' | 'and' | 'next' | 'action';
  /** True if it is shown beside a selected symbol. */
  near?: boolean;
  when: () => boolean;
  /** False if a menu has no row for it, because another command does the same now. */
  listed?: () => boolean;
  /** For a command that is on or off: true if it is on. */
  checked?: () => boolean;
  run: () => unknown;
  /** True if a line separates it from the command above. */
  group?: boolean;
}

const one = (part: string) => editor.one?.part === part;
const ids = () => [...shell.selection];
const some = () => editor.selected.length > 0;
const count = () => editor.selected.filter((i) => i.part === 'step' || i.part === 'transition').length;
const symbols = () => count() > 0;
const many = () => count() > 1;
const step = () => one('step');
const transition = () => one('transition');
const id = () => editor.one?.id ?? '';

/** The place where the context menu was opened. */
const here = () => (editor.menu ? editor.toPlane(editor.menu.x, editor.menu.y) : undefined);

const align = (how: 'left' | 'top' | 'center' | 'distribute_x' | 'distribute_y') =>
  editor.apply({ g: 'align', ids: ids(), how });

export const commands: Command[] = [
  {
    id: 'open',
    title: 'cmd.open',
    keys: ['Enter'],
    near: true,
    icon: 'chevron',
    when: () => !!editor.one?.macro || !!editor.one?.encloses?.length || one('title'),
    run: () => editor.one && editor.enter(editor.one),
  },
  {
    id: 'openBeside',
    title: 'cmd.openBeside',
    keys: ['E'],
    when: () => step() && editor.chart !== SHEET && editor.elsewhere === null && (!!editor.one?.macro || !!editor.one?.encloses?.length),
    checked: () => editor.isOpened(editor.one),
    run: () => editor.one && editor.openBeside(editor.one),
  },
  {
    id: 'receptivity',
    title: 'cmd.receptivity',
    keys: ['Enter'],
    near: true,
    icon: 'pencil',
    when: transition,
    run: () => editor.edit(id(), 'receptivity'),
  },
  {
    id: 'editAction',
    title: 'cmd.editAction',
    keys: ['Enter'],
    near: true,
    icon: 'pencil',
    when: () => one('action'),
    run: () => editor.edit(id()),
  },
  {
    id: 'next',
    title: 'cmd.next',
    keys: ['Tab'],
    near: true,
    icon: 'next',
    when: () => step() || transition(),
    run: () => editor.apply({ g: 'next', id: id() }),
  },
  {
    id: 'before',
    title: 'cmd.before',
    keys: ['Shift+Tab'],
    icon: 'up',
    when: () => step() || transition(),
    run: () => editor.apply({ g: 'before', id: id() }),
  },
  {
    id: 'or',
    title: 'cmd.or',
    keys: ['O'],
    near: true,
    icon: 'or',
    when: step,
    run: () => editor.apply({ g: 'branch', id: id(), how: 'or' }),
  },
  {
    id: 'and',
    title: 'cmd.and',
    keys: ['P'],
    near: true,
    icon: 'and',
    when: transition,
    run: () => editor.apply({ g: 'branch', id: id(), how: 'and' }),
  },
  {
    id: 'action',
    title: 'cmd.action',
    keys: ['A'],
    near: true,
    icon: 'action',
    when: step,
    run: () => editor.edit(id(), 'action'),
  },
  {
    id: 'declare',
    title: 'cmd.declare',
    keys: ['D'],
    near: true,
    icon: 'check',
    when: () => editor.undeclared.length > 0,
    run: () => editor.declare(editor.undeclared),
  },
  {
    id: 'straighten',
    title: 'cmd.straighten',
    near: true,
    icon: 'undo',
    when: () => editor.one?.part === 'link' && editor.one.bent !== undefined,
    run: () => editor.straighten(),
  },
  {
    id: 'otherForm',
    title: 'cmd.asJump',
    name: () => t(one('connector') ? 'cmd.asLine' : 'cmd.asJump'),
    keys: ['J'],
    near: true,
    icon: 'target',
    when: () => one('link') || one('connector'),
    run: () => editor.otherForm(),
  },
  {
    id: 'stacked',
    title: 'cmd.row',
    when: () => step() && (editor.scene?.actions.get(id())?.length ?? 0) > 1,
    checked: () => (editor.one?.stacked ?? editor.scene?.drawing.actions) === 'row',
    run: () => editor.stackOtherwise(),
  },
  {
    id: 'why',
    title: 'why.symbol',
    keys: ['W'],
    icon: 'help',
    when: () => (step() || transition()) && runs.current !== null,
    run: () => runs.current && why.ask(runs.current, id()),
  },
  {
    id: 'nextLink',
    title: 'cmd.nextLink',
    keys: ['L'],
    when: () => step() || transition() || one('link') || one('connector'),
    run: () => editor.nextLink(),
  },
  {
    id: 'jump',
    title: 'cmd.jump',
    keys: ['J'],
    when: () => step() || transition(),
    run: () => (shell.dialog = 'jump'),
  },
  {
    id: 'convergeOr',
    title: 'cmd.convergeOr',
    near: true,
    icon: 'or',
    keys: ['O'],
    when: many,
    run: () => editor.apply({ g: 'converge', ids: ids(), how: 'or' }),
  },
  {
    id: 'convergeAnd',
    title: 'cmd.convergeAnd',
    near: true,
    icon: 'and',
    keys: ['P'],
    when: many,
    run: () => editor.apply({ g: 'converge', ids: ids(), how: 'and' }),
  },
  {
    id: 'parallel',
    title: 'cmd.parallel',
    when: symbols,
    run: () => editor.apply({ g: 'parallel', ids: ids() }),
  },
  {
    id: 'macro',
    title: 'cmd.macro',
    keys: ['M'],
    when: symbols,
    run: () => editor.apply({ g: 'macro', ids: ids() }),
  },
  {
    id: 'rename',
    title: 'cmd.rename',
    keys: ['F2'],
    group: true,
    when: step,
    run: () => editor.edit(id(), 'name'),
  },
  {
    id: 'initial',
    title: 'cmd.initial',
    keys: ['I'],
    when: step,
    checked: () => editor.one?.initial ?? false,
    run: () => editor.apply({ g: 'initial', id: id(), on: !editor.one?.initial }),
  },
  {
    id: 'label',
    title: 'cmd.label',
    keys: ['F2'],
    when: transition,
    run: () => editor.edit(id(), 'label'),
  },
  {
    id: 'priority',
    title: 'cmd.priority',
    when: transition,
    run: () => editor.edit(id(), 'priority'),
  },
  {
    id: 'comment',
    title: 'cmd.comment',
    keys: ['C'],
    when: () => step() || transition() || one('comment'),
    run: () => editor.edit(id(), 'comment'),
  },
  {
    id: 'note',
    title: 'cmd.note',
    keys: ['C'],
    when: () => !some(),
    run: () => editor.note(here() ?? editor.beside()),
  },
  {
    id: 'breakpoint',
    title: 'cmd.breakpoint',
    keys: ['F9'],
    when: () => step() || transition(),
    checked: () => !!editor.file && runs.breaks(editor.file.name).includes(id()),
    run: () => editor.file && runs.toggleBreak(editor.file.name, id()),
  },
  {
    id: 'cut',
    title: 'cmd.cut',
    keys: ['Ctrl+X'],
    group: true,
    when: some,
    run: () => editor.cut(),
  },
  { id: 'copy', title: 'cmd.copy', keys: ['Ctrl+C'], when: some, run: () => editor.copy() },
  { id: 'paste', title: 'cmd.paste', keys: ['Ctrl+V'], when: () => true, run: () => editor.paste(undefined, here()) },
  {
    id: 'delete',
    title: 'cmd.delete',
    keys: ['Delete', 'Backspace'],
    near: true,
    icon: 'trash',
    name: () => (editor.joined === '' ? t('cmd.deleteOnly') : t('cmd.deleteJoin', { what: editor.joined })),
    when: some,
    run: () => editor.remove(true),
  },
  {
    id: 'deleteOnly',
    title: 'cmd.deleteOnly',
    keys: ['Shift+Delete'],
    when: some,
    listed: () => editor.joined !== '',
    run: () => editor.remove(false),
  },
  { id: 'all', title: 'cmd.all', keys: ['Ctrl+A'], when: () => true, run: () => editor.selectAll() },
  { id: 'alignLeft', title: 'cmd.alignLeft', group: true, when: many, run: () => align('left') },
  { id: 'alignTop', title: 'cmd.alignTop', when: many, run: () => align('top') },
  { id: 'alignCenter', title: 'cmd.alignCenter', when: many, run: () => align('center') },
  { id: 'distributeX', title: 'cmd.distributeX', when: many, run: () => align('distribute_x') },
  { id: 'distributeY', title: 'cmd.distributeY', when: many, run: () => align('distribute_y') },
  {
    id: 'addStep',
    title: 'cmd.addStep',
    keys: ['Insert'],
    group: true,
    when: () => !some(),
    run: () => editor.chart !== null && editor.apply({ g: 'add_step', chart: editor.chart }),
  },
  {
    id: 'tidy',
    title: 'cmd.tidy',
    when: () => !some(),
    run: () => editor.chart !== null && editor.apply({ g: 'tidy', chart: editor.chart }),
  },
  {
    id: 'showText',
    title: 'cmd.showText',
    keys: ['Ctrl+E'],
    group: true,
    when: () => editor.one !== null,
    run: () => editor.file && editor.one && shell.showText(editor.file, editor.one.from, editor.one.to),
  },
  {
    id: 'fit',
    title: 'canvas.zoomFit',
    keys: ['F', 'Home'],
    icon: 'fit',
    when: () => true,
    run: () => editor.camera?.fit(),
  },
  {
    id: 'picture',
    title: 'picture.draw',
    name: () => t(editor.file?.look.pictures.length ? 'picture.edit' : 'picture.draw'),
    when: () => (editor.file?.look.plants.length ?? 0) > 0,
    run: () => (shell.dialog = 'picture'),
  },
  { id: 'print', title: 'app.print', keys: ['Ctrl+P'], when: () => editor.file !== null, run: () => (shell.dialog = 'print') },
];

/** The title of a command now, in the language of the page. */
export const commandName = (command: Command): string => command.name?.() ?? t(command.title);

/** The name of a key as the table writes it. */
export function keyName(e: KeyboardEvent): string {
  const key = e.key === ' ' ? 'Space' : e.key.length === 1 ? e.key.toUpperCase() : e.key;
  return `${e.ctrlKey || e.metaKey ? 'Ctrl+' : ''}${e.altKey ? 'Alt+' : ''}${e.shiftKey && key.length > 1 ? 'Shift+' : ''}${key}`;
}

/** The command that a key executes now. */
export function commandOf(e: KeyboardEvent): Command | undefined {
  const name = keyName(e);
  return commands.find((c) => c.keys?.includes(name) && c.when());
}
