// Converts typed values to the notation of the language.
import type { SignalRow } from '../lib/protocol';

/** `5` for a REAL becomes 5.0, and a text gets quotes. */
export function literal(row: SignalRow, typed: string): string {
  const text = typed.trim();
  if (row.type === 'real' && /^[+-]?\d+$/.test(text)) return `${text}.0`;
  if (row.type === 'text' && !/^'.*'$/.test(text)) return `'${typed.replace(/[$']/g, (c) => `$${c}`)}'`;
  return text;
}
