// The order and the names of rows in the tables of variables.
import type { VariableRow } from '../lib/protocol';

export type Class = VariableRow['class'];
export const CLASSES: readonly Class[] = ['input', 'output', 'var', 'const'];

export const TYPES = [
  'BOOL', 'INT', 'DINT', 'REAL', 'TIME', 'STRING', 'SINT', 'LINT', 'USINT', 'UINT', 'UDINT', 'ULINT', 'LREAL',
  'CTU', 'CTD', 'CTUD', 'TON', 'TOF', 'TP', 'R_TRIG', 'F_TRIG', 'SR', 'RS',
];

/** The name that gestures use. */
export const fullName = (row: VariableRow): string => (row.chart ? `${row.chart}.${row.name}` : row.name);

/** The properties that each class has. */
export const HAS: Record<Class, { address: boolean; inverted: boolean; retain: boolean; safe: boolean }> = {
  input: { address: true, inverted: true, retain: false, safe: false },
  output: { address: true, inverted: true, retain: false, safe: true },
  var: { address: true, inverted: false, retain: true, safe: false },
  const: { address: false, inverted: false, retain: false, safe: false },
};

/** The parts of a row that remain when its class changes. */
export function fitting(row: Partial<VariableRow>, to: Class): Partial<VariableRow> {
  const has = HAS[to];
  return {
    ...row,
    class: to,
    address: has.address ? (row.address ?? '') : '',
    inverted: has.inverted && (row.inverted ?? false),
    retain: has.retain && (row.retain ?? false),
    safe: has.safe ? (row.safe ?? '') : '',
    ...(to === 'const' && !row.init ? { init: row.type === 'BOOL' ? 'TRUE' : '0' } : {}),
  };
}

export function matches(row: VariableRow, wanted: string): boolean {
  const low = wanted.trim().toLowerCase();
  if (!low) return true;
  return [fullName(row), row.type, row.address, row.comment].some((text) => text?.toLowerCase().includes(low));
}

/** Orders by the kind of address, then by its numbers. */
export function byAddress(a: VariableRow, b: VariableRow): number {
  const key = (text = '') => text.replace(/\d+/g, (n) => n.padStart(8, '0'));
  const [x, y] = [key(a.address), key(b.address)];
  return x < y ? -1 : x > y ? 1 : 0;
}
