// What a user types, as the language writes it.
import type { SignalRow } from '../lib/protocol';

/** `5` for a REAL is 5.0, and a text stands in quotes. */
export function literal(row: SignalRow, typed: string): string {
  const text = typed.trim();
  if (row.type === 'real' && /^[+-]?\d+$/.test(text)) return `${text}.0`;
  if (row.type === 'text' && !/^'.*'$/.test(text)) return `'${typed.replace(/[$']/g, (c) => `$${c}`)}'`;
  return text;
}
