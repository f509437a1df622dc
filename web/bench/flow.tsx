// The same chart in React Flow: only the visible part, or all of it (`?all`).
import '@xyflow/react/dist/style.css';
import { Handle, Position, ReactFlow, useNodesState, type Edge, type Node, type NodeProps, type ReactFlowInstance } from '@xyflow/react';
import { createElement as h, memo, useEffect } from 'react';
import { createRoot } from 'react-dom/client';
import { active, LENGTH } from './chart';

type Data = { n: number; on?: boolean };
const onlyVisible = !location.search.includes('all');

const ends = [h(Handle, { key: 't', type: 'target', position: Position.Top }), h(Handle, { key: 's', type: 'source', position: Position.Bottom })];
const Step = memo(({ data }: NodeProps<Node<Data>>) =>
  h(
    'div',
    { style: { width: 50, height: 50, border: `${data.on ? 4 : 2}px solid ${data.on ? '#1a1' : '#000'}`, boxSizing: 'border-box', textAlign: 'center', lineHeight: '46px' } },
    data.n,
    data.on ? h('i', { style: { position: 'absolute', left: 20, top: 36, width: 10, height: 10, borderRadius: 5, background: '#1a1' } }) : null,
    ...ends,
  ),
);
const Transition = memo(({ data }: NodeProps<Node<Data>>) =>
  h('div', { style: { width: 44, height: 4, background: data.on ? '#1a1' : '#000' } }, h('span', { style: { position: 'absolute', left: 54, top: -9, whiteSpace: 'nowrap' } }, 'a·b+↑c'), ...ends),
);
const nodeTypes = { step: Step, transition: Transition };

function nodes(steps: number): Node<Data>[] {
  const found: Node<Data>[] = [];
  for (let i = 0; i < steps; i++) {
    const [x, y] = [Math.floor(i / LENGTH) * 260, (i % LENGTH) * 130];
    found.push({ id: `s${i}`, type: 'step', position: { x, y }, data: { n: i }, width: 50, height: 50 });
    found.push({ id: `t${i}`, type: 'transition', position: { x: x + 3, y: y + 88 }, data: { n: i }, width: 44, height: 4 });
  }
  return found;
}

function edges(steps: number): Edge[] {
  const found: Edge[] = [];
  for (let i = 0; i < steps; i++) {
    const to = i % LENGTH === LENGTH - 1 ? i - LENGTH + 1 : i + 1;
    found.push({ id: `a${i}`, source: `s${i}`, target: `t${i}`, type: 'step' }, { id: `b${i}`, source: `t${i}`, target: `s${to}`, type: 'step' });
  }
  return found;
}

const frame = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
let flow: ReactFlowInstance<Node<Data>> | undefined;
let steps = 1000;
let put: (change: (now: Node<Data>[]) => Node<Data>[]) => void = () => undefined;
let was = new Set<string>();

function App({ count }: { count: number }) {
  const [list, setList, changed] = useNodesState<Node<Data>>(nodes(count));
  useEffect(() => {
    put = setList;
  }, [setList]);
  return h(ReactFlow<Node<Data>>, {
    nodes: list,
    defaultEdges: edges(count),
    nodeTypes,
    onNodesChange: changed,
    onlyRenderVisibleElements: onlyVisible,
    minZoom: 0.02,
    panOnScroll: false,
    nodesDraggable: false,
    defaultViewport: { x: 100, y: 40, zoom: 1 },
    onInit: (instance) => (flow = instance),
  });
}

Object.assign(window, {
  bench: {
    ready: async () => undefined,
    async show(n: number) {
      steps = n;
      const target = document.getElementById('app');
      if (target) createRoot(target).render(h(App, { count: n }));
      while (!document.querySelector('.react-flow__node')) await frame();
      await frame();
    },
    tick(n: number) {
      const now = new Set(active(steps, n).flatMap((i) => [`s${i}`, `t${i}`]));
      const before = was;
      was = now;
      put((list) => list.map((node) => (now.has(node.id) === before.has(node.id) ? node : { ...node, data: { ...node.data, on: now.has(node.id) } })));
    },
    whole: () => flow?.fitView({ minZoom: 0.02 }),
    actual: () => flow?.setViewport({ x: 100, y: 40, zoom: 1 }),
  },
});
