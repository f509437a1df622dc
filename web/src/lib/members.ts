// Variables with members as a tree: `control[1].button.q` stands in `control`, `[1]` and `button`.

/** A row of the list, or several that have the beginning of their names in common. */
export type Node<R> = { name: string; label: string; row: R } | { name: string; label: string; count: number; inside: Node<R>[] };

/** The parts of a name: a member belongs to what stands before it, and an element with members to its array. */
function parts(name: string): string[] {
  const members = name.split('.');
  const last = members.pop() ?? name;
  const before = members.flatMap((part) => /^(.+?)(\[[^\]]*\])$/.exec(part)?.slice(1) ?? [part]);
  return [...before, last];
}

/** The name of a node under another one. */
const under = (name: string, part: string) => (name === '' ? part : part.startsWith('[') ? name + part : `${name}.${part}`);

/** The rows in their order; those with a common beginning stand where the first of them stands. */
export function tree<R>(rows: readonly R[], nameOf: (row: R) => string): Node<R>[] {
  return nodes(rows.map((row) => ({ row, parts: parts(nameOf(row)) })), '');
}

function nodes<R>(rows: readonly { row: R; parts: string[] }[], name: string): Node<R>[] {
  const groups = new Map<string, { row: R; parts: string[] }[]>();
  for (const row of rows) {
    // A variable and a group can have one name.
    const key = `${row.parts.length > 1 ? 'in' : 'is'} ${row.parts[0]}`;
    groups.set(key, [...(groups.get(key) ?? []), row]);
  }
  return [...groups.values()].flatMap((group): Node<R>[] => {
    const first = group[0];
    if (!first) return [];
    const label = first.parts[0] ?? '';
    const full = under(name, label);
    if (group.length === 1) {
      const whole = first.parts.reduce(under, '');
      return [{ name: first.parts.reduce(under, name), label: whole, row: first.row }];
    }
    if (first.parts.length === 1) return group.map(({ row }) => ({ name: full, label, row }));
    const inside = nodes(group.map(({ row, parts: [, ...rest] }) => ({ row, parts: rest })), full);
    return [{ name: full, label, count: group.length, inside }];
  });
}
