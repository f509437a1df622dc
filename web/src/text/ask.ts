// The questions of the text view to the checker: completion, hover, problems, references.
import type { Completion, CompletionContext, CompletionResult } from '@codemirror/autocomplete';
import type { Action, Diagnostic } from '@codemirror/lint';
import type { EditorState } from '@codemirror/state';
import { hoverTooltip } from '@codemirror/view';
import type { OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { page } from '../lib/page';
import type { Fix, Problem } from '../lib/protocol';
import { shell } from '../lib/shell.svelte';
import { explanation } from './explain';
import { markdown } from './markdown';
import { tell } from './window';
import { asUnit } from './sync';

const KINDS: Record<string, string> = {
  step: 'property',
  chart: 'class',
  variable: 'variable',
  keyword: 'keyword',
  type: 'type',
  profile: 'constant',
  function: 'function',
  member: 'property',
  name: 'text',
  plant: 'namespace',
};

export function completion(file: OpenFile) {
  return async (context: CompletionContext): Promise<CompletionResult | null> => {
    const before = context.matchBefore(/[\p{L}\p{N}_.%`]+/u);
    if (!before && !context.explicit) return null;
    await file.settled();
    // A change before the place, as by a gesture, moves it: an answer would belong to another place.
    const moved = context.view?.state.sliceDoc(0, context.pos) !== context.state.sliceDoc(0, context.pos);
    if (context.aborted || moved) return null;
    const found = await page.call({ do: 'complete', file: file.name, at: context.pos }).catch(() => null);
    if (!found || found.items.length === 0) return null;
    const options = found.items.map((item): Completion => ({
      label: item.label,
      type: KINDS[item.kind] ?? 'text',
      ...(item.detail ? { detail: item.detail } : {}),
      ...(item.insert && item.insert !== item.label ? { apply: item.insert } : {}),
    }));
    return { from: found.from, options, validFor: /^[\p{L}\p{N}_]*$/u };
  };
}

export function hover(file: OpenFile) {
  return hoverTooltip(async (view, at) => {
    const { doc } = view.state;
    await file.settled();
    // The message of the problem is enough here.
    if (file.look.problems.some((p) => p.from <= at && at <= p.to)) return null;
    const found = await page.call({ do: 'hover', file: file.name, at }).catch(() => null);
    if (!found || view.state.doc !== doc) return null;
    return {
      pos: found.from,
      end: found.to,
      above: true,
      create: () => {
        const dom = markdown(found.markdown);
        dom.className = 'g7-hover';
        return { dom };
      },
    };
  });
}

function mend(file: OpenFile, problem: Problem, fix: Fix, n: number): Action {
  const { splices } = fix;
  return {
    name: fix.title.replaceAll('`', ''),
    apply: (view) => {
      if (splices) view.dispatch({ changes: splices, annotations: asUnit.of(true), userEvent: 'input.fix' });
      else void shell.try(() => file.mend(problem, n));
    },
  };
}

/** Explains the kind of a problem, at its place. */
function why(code: string): Action {
  return {
    name: t('text.why'),
    apply: (view, from) => {
      void shell.try(async () => {
        const said = await explanation(code);
        const about = markdown(said.markdown);
        about.lang = said.language;
        tell(view, from, about);
      });
    },
  };
}

export function diagnostics(file: OpenFile, length: number): Diagnostic[] {
  return file.look.problems.map((p) => ({
    from: Math.min(p.from, length),
    to: Math.min(Math.max(p.to, p.from), length),
    severity: p.severity,
    source: p.code,
    message: p.what,
    renderMessage: () => markdown(p.help ? `${p.what}\n\n${p.help}` : p.what),
    actions: [...p.fixes.map((fix, n) => mend(file, p, fix, n)), why(p.code)],
  }));
}

export interface Named {
  places: [from: number, to: number][];
  /** The place of its declaration. */
  declared: [from: number, to: number];
  /** The name that a gesture uses. */
  id?: string;
  name?: string;
  word: string;
}

/** The name at a place, and all other places where it is used. */
export async function named(file: OpenFile, state: EditorState, at: number): Promise<Named | null> {
  await file.settled();
  const places = await page.call({ do: 'references', file: file.name, at }).catch(() => []);
  const here = places.find(([from, to]) => from <= at && at <= to) ?? places[0];
  if (!here) return null;
  const symbols = await page.call({ do: 'symbols', file: file.name });
  const same = (row: { from: number; to: number }) => places.some(([from, to]) => row.from <= from && to <= row.to && row.to - row.from < 200);
  const step = symbols.steps.find(same);
  const variable = step ? undefined : symbols.variables.find(same);
  const heads = file.look.charts.filter((c) => !c.file).map((c) => ({ name: c.name, from: state.doc.sliceString(c.from, c.to).indexOf(c.name) + c.from }));
  const chart = step || variable ? undefined : heads.find((c) => places.some(([from, to]) => from <= c.from && c.from < to));
  const row = step ?? variable;
  const declared = (row ? places.find(([from, to]) => row.from <= from && to <= row.to) : places.find(([from]) => chart && from <= chart.from)) ?? here;
  return {
    places,
    declared: chart ? (places.find(([from, to]) => from <= chart.from && chart.from < to) ?? declared) : declared,
    word: state.doc.sliceString(declared[0], declared[1]),
    ...(step ? { id: step.id } : chart ? { id: chart.name } : variable ? { name: variable.chart ? `${variable.chart}.${variable.name}` : variable.name } : {}),
  };
}
