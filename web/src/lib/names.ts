// The gesture that declares names, alone or with the gesture that names them.
import type { Gesture, Undeclared } from './protocol';

/** A name and its declaration. */
export type NewName = Pick<Undeclared, 'name' | 'class' | 'type'>;

export function declaration(names: readonly NewName[], gesture?: Gesture | null): Gesture {
  const rows = names.map(({ name, class: of, type }) => ({ name, class: of, type }));
  return { g: 'declare', rows, ...(gesture ? { with: gesture } : {}) };
}

/** Names in a sentence. */
export const listed = (names: readonly NewName[]): string => names.map((n) => n.name).join(', ');
