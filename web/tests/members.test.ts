// The variables of structures and function blocks as a tree.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { tree, type Node } from '../src/lib/members.js';

/** Each node on a line: its label, and the number of its rows if it is a group. */
function lines(nodes: Node<string>[], depth = 0): string[] {
  return nodes.flatMap((node) => {
    const indent = '  '.repeat(depth);
    return 'row' in node ? [`${indent}${node.label} = ${node.row}`] : [`${indent}${node.label} ${node.count}`, ...lines(node.inside, depth + 1)];
  });
}

test('names with a common beginning stand together, in their order', () => {
  const names = ['order[1]', 'order[2]', 'drive[1].running', 'drive[2].running', 'drive[1].limits[0]', 'n', 'k.speed', 'k.on', 'lone.speed'];
  assert.deepEqual(lines(tree(names, (n) => n)), [
    'order[1] = order[1]',
    'order[2] = order[2]',
    'drive 3',
    '  [1] 2',
    '    running = drive[1].running',
    '    limits[0] = drive[1].limits[0]',
    '  [2].running = drive[2].running',
    'n = n',
    'k 2',
    '  speed = k.speed',
    '  on = k.on',
    'lone.speed = lone.speed',
  ]);
});

test('a variable and a group can have one name, and names of groups are whole', () => {
  const nodes = tree(['a', 'a.x', 'a.y', 'G.d[1].t.Q', 'G.d[1].t.ET', 'G.d[2].t.Q'], (n) => n);
  const all: string[] = [];
  const walk = (list: Node<string>[]): void => list.forEach((n) => (all.push(n.name), 'row' in n || walk(n.inside)));
  walk(nodes);
  assert.deepEqual(all, ['a', 'a', 'a.x', 'a.y', 'G', 'G.d', 'G.d[1]', 'G.d[1].t', 'G.d[1].t.Q', 'G.d[1].t.ET', 'G.d[2].t.Q']);
});
