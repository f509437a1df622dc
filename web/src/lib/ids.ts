// Ids of symbols: `Chart/s/Step`, `Chart/a/Step/0`, `Chart/t/3`, … as the Rust crate `g7-edit`
// writes them; the characters `/ > : %` inside a name are written %2F %3E %3A %25.

/** The name under which all charts of a file stand on one sheet; no chart has it. */
export const SHEET = '*';

export type IdKind = 's' | 'a' | 't' | 'l' | 'c' | 'n' | 'x';

const decode = (text: string): string => text.replace(/%(2F|3E|3A|25)/g, (code) => decodeURIComponent(code));
const encode = (text: string): string => text.replace(/[/>:%]/g, (c) => `%${c.charCodeAt(0).toString(16).toUpperCase()}`);

export function chartOf(id: string): string {
  return decode(id.split('/')[0] ?? '');
}

export function kindOf(id: string): IdKind | undefined {
  return id.split('/')[1] as IdKind | undefined;
}

/** The id of the title of a symbol's chart, on a sheet of several charts. */
export const titleOf = (id: string): string => id.split('/')[0] ?? '';

/** The name of the step, or the number of the transition, in an id. */
export function nameIn(id: string): string {
  return decode(id.split('/')[2] ?? '');
}

export function stepId(chart: string, step: string): string {
  return `${encode(chart)}/s/${encode(step)}`;
}

/** The step of an action, and the number of the action there. */
export function actionOf(id: string): { step: string; index: number } | null {
  const [chart, kind, step, index] = id.split('/');
  if (kind !== 'a' || step === undefined) return null;
  return { step: `${chart}/s/${step}`, index: Number(index) };
}

export function actionId(step: string, index: number): string {
  return `${step.replace('/s/', '/a/')}/${index}`;
}

export function transitionNumber(id: string): number {
  return Number(id.split('/')[2]);
}

/** The id of the part at the start of a link, for a link that is drawn in two parts. */
export const leavingPart = (link: string): string => (kindOf(link) === 'l' ? `${link.replace('/l/', '/c/')}/leaving` : link);
