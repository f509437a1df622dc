// The lanes of a chronogram: edges as the run sends them, and their painting.
import type { SignalType } from '../lib/protocol';

/** A value from an instant on; NaN: it is not known. */
export type Edge = [ms: number, value: number, show: string];

/** Many changes in one place. */
export interface Busy {
  from: number;
  to: number;
  count: number;
  low: number;
  high: number;
}

export interface Lane {
  name: string;
  type: SignalType;
  step: boolean;
  edges: Edge[];
  busy?: Busy[];
  /** In px, if it is not that of all. */
  height?: number;
}

export interface Span {
  from: number;
  to: number;
}

export interface Colours {
  ink: string;
  soft: string;
  line: string;
  grid: string;
  accent: string;
  accentSoft: string;
  green: string;
  greenSoft: string;
  amber: string;
  violet: string;
  paper: string;
  font: string;
}

export const HEIGHT = 30;
export const AXIS = 24;

/** The index of the last edge at an instant or before it; -1 if there is none. */
export function at(edges: readonly Edge[], ms: number): number {
  let low = 0;
  let high = edges.length;
  while (low < high) {
    const mid = (low + high) >> 1;
    if ((edges[mid] as Edge)[0] <= ms) low = mid + 1;
    else high = mid;
  }
  return low - 1;
}

/** The round interval (1, 2 or 5 times a power of ten) nearest to the wished one. */
export function tick(span: number, wished: number): number {
  const raw = span / Math.max(1, wished);
  const power = 10 ** Math.floor(Math.log10(Math.max(raw, 1e-6)));
  const n = raw / power;
  return power * (n <= 1 ? 1 : n <= 2 ? 2 : n <= 5 ? 5 : 10);
}

export function showTime(ms: number, step = 1): string {
  const digits = step >= 1000 ? 0 : step >= 100 ? 1 : step >= 10 ? 2 : 3;
  return `${(ms / 1000).toFixed(digits)} s`;
}

export interface Painting {
  width: number;
  height: number;
  span: Span;
  /** The present; later values are not known. */
  now: number;
  /** The instant of the past that the chart shows. */
  seen?: number | null;
  lanes: readonly Lane[];
  /** Times with their texts, in place of seconds. */
  ticks?: readonly (readonly [ms: number, text: string])[];
  /** Spans in which nothing is known. */
  gaps?: readonly Span[];
  cursors: readonly (number | null)[];
  colours: Colours;
}

export function paint(g: CanvasRenderingContext2D, p: Painting): void {
  const { width, height, span, colours } = p;
  const scale = width / Math.max(span.to - span.from, 1e-6);
  const x = (ms: number) => (ms - span.from) * scale;
  g.clearRect(0, 0, width, height);
  g.font = `11px ${colours.font}`;
  g.textBaseline = 'middle';
  grid(g, p, x);
  let top = 0;
  for (const lane of p.lanes) {
    const high = lane.height ?? HEIGHT;
    g.save();
    g.beginPath();
    g.rect(0, top, Math.max(0, Math.min(width, x(p.now))), high);
    g.clip();
    if (lane.type === 'bool') square(g, p, lane, top, x);
    else if (lane.type === 'real') curve(g, p, lane, top, x);
    else boxes(g, p, lane, top, x);
    g.restore();
    g.strokeStyle = colours.grid;
    g.lineWidth = 1;
    line(g, 0, top + high - 0.5, width, top + high - 0.5);
    top += high;
  }
  hatch(g, p, x);
  cursors(g, p, x);
}

type X = (ms: number) => number;

function line(g: CanvasRenderingContext2D, x1: number, y1: number, x2: number, y2: number): void {
  g.beginPath();
  g.moveTo(x1, y1);
  g.lineTo(x2, y2);
  g.stroke();
}

function* ticks({ span, width, ticks: given }: Painting): Generator<readonly [ms: number, text: string]> {
  if (given) return yield* given;
  const step = tick(span.to - span.from, width / 90);
  for (let ms = Math.ceil(span.from / step) * step; ms <= span.to; ms += step) yield [ms, showTime(ms, step)];
}

/** Hatches the spans in which nothing is known. */
function hatch(g: CanvasRenderingContext2D, { width, height, gaps, colours }: Painting, x: X): void {
  for (const gap of gaps ?? []) {
    const from = Math.max(0, x(gap.from));
    const to = Math.min(width, x(gap.to));
    if (to < 0 || from > width) continue;
    g.save();
    g.beginPath();
    g.rect(from, 0, Math.max(to - from, 2), height);
    g.clip();
    g.fillStyle = colours.paper;
    g.fillRect(from, 0, Math.max(to - from, 2), height);
    g.strokeStyle = colours.soft;
    g.lineWidth = 1;
    for (let k = from - height - ((from - height) % 8); k < to; k += 8) line(g, k, height, k + height, 0);
    g.restore();
  }
}

function grid(g: CanvasRenderingContext2D, p: Painting, x: X): void {
  const { height, colours } = p;
  g.lineWidth = 1;
  g.strokeStyle = colours.grid;
  for (const [ms] of ticks(p)) line(g, Math.round(x(ms)) + 0.5, 0, Math.round(x(ms)) + 0.5, height);
}

/** Paints the times above the lanes, and the heads of the cursors. */
export function paintAxis(g: CanvasRenderingContext2D, p: Painting): void {
  const { width, span, colours } = p;
  const x = (ms: number) => (ms - span.from) * (width / Math.max(span.to - span.from, 1e-6));
  g.clearRect(0, 0, width, AXIS);
  g.font = `11px ${colours.font}`;
  g.textBaseline = 'middle';
  g.textAlign = 'left';
  g.lineWidth = 1;
  g.strokeStyle = colours.line;
  for (const [ms, text] of ticks(p)) {
    const at = Math.round(x(ms)) + 0.5;
    line(g, at, AXIS - 5, at, AXIS);
    g.fillStyle = colours.soft;
    g.fillText(text, at + 3, AXIS / 2);
  }
  line(g, 0, AXIS - 0.5, width, AXIS - 0.5);
  if (inSpan(p.seen, span)) {
    const at = Math.round(x(p.seen)) + 0.5;
    g.fillStyle = colours.accent;
    g.beginPath();
    g.moveTo(at - 6, AXIS - 10);
    g.lineTo(at + 6, AXIS - 10);
    g.lineTo(at, AXIS);
    g.fill();
  }
  p.cursors.forEach((ms, i) => {
    if (!inSpan(ms, span)) return;
    const at = Math.round(x(ms)) + 0.5;
    const left = at < width - 20 ? at : at - 14;
    g.fillStyle = i === 0 ? colours.amber : colours.violet;
    g.fillRect(at - 0.75, 0, 1.5, AXIS);
    g.fillRect(left, 0, 14, 13);
    g.fillStyle = colours.paper;
    g.textAlign = 'center';
    g.fillText(i === 0 ? 'A' : 'B', left + 7, 7);
    g.textAlign = 'left';
  });
}

/** The visible edges, including the one before them. */
function* inSight(lane: Lane, span: Span): Generator<[Edge, number]> {
  for (let i = Math.max(0, at(lane.edges, span.from)); i < lane.edges.length; i++) {
    const edge = lane.edges[i] as Edge;
    if (edge[0] > span.to) return;
    yield [edge, lane.edges[i + 1]?.[0] ?? Infinity];
  }
}

function square(g: CanvasRenderingContext2D, { width, span, colours }: Painting, lane: Lane, top: number, x: X): void {
  const high = top + 7;
  const low = top + (lane.height ?? HEIGHT) - 7;
  g.fillStyle = lane.step ? colours.greenSoft : colours.accentSoft;
  g.strokeStyle = lane.step ? colours.green : colours.accent;
  g.lineWidth = 1.5;
  g.beginPath();
  let begun = false;
  for (const [edge, until] of inSight(lane, span)) {
    if (Number.isNaN(edge[1])) {
      begun = false;
      continue;
    }
    const from = Math.max(-2, x(edge[0]));
    const to = Math.min(width + 2, x(until));
    const y = edge[1] ? high : low;
    if (edge[1]) g.fillRect(from, high, Math.max(to - from, 1), low - high);
    if (begun) g.lineTo(from, y);
    else g.moveTo(from, y);
    g.lineTo(to, y);
    begun = true;
  }
  g.stroke();
  // So many edges that they are one block.
  g.fillStyle = lane.step ? colours.green : colours.accent;
  for (const { from, to } of lane.busy ?? []) g.fillRect(x(from), high, Math.max(x(to) - x(from), 1.5), low - high);
}

/** Paints values as boxes that contain the value if there is room. */
function boxes(g: CanvasRenderingContext2D, { width, span, colours }: Painting, lane: Lane, top: number, x: X): void {
  const high = top + 6;
  const low = top + HEIGHT - 6;
  g.strokeStyle = colours.violet;
  g.lineWidth = 1.2;
  g.textAlign = 'left';
  for (const [edge, until] of inSight(lane, span)) {
    const from = Math.max(-4, x(edge[0]));
    const to = Math.min(width + 4, x(until));
    const slant = Math.min(3, (to - from) / 2);
    g.beginPath();
    g.moveTo(from, (high + low) / 2);
    g.lineTo(from + slant, high);
    g.lineTo(to - slant, high);
    g.lineTo(to, (high + low) / 2);
    g.lineTo(to - slant, low);
    g.lineTo(from + slant, low);
    g.closePath();
    g.stroke();
    if (to - from < 16) continue;
    g.fillStyle = colours.ink;
    const room = Math.floor((to - from - 8) / 6.2);
    g.fillText(edge[2].length > room ? `${edge[2].slice(0, Math.max(0, room - 1))}…` : edge[2], Math.max(from, 0) + 6, (high + low) / 2 + 0.5);
  }
}

function curve(g: CanvasRenderingContext2D, { span, colours, now }: Painting, lane: Lane, top: number, x: X): void {
  let least = Infinity;
  let most = -Infinity;
  for (const [, value] of lane.edges) {
    if (Number.isNaN(value)) continue;
    least = Math.min(least, value);
    most = Math.max(most, value);
  }
  for (const { low, high } of lane.busy ?? []) {
    least = Math.min(least, low);
    most = Math.max(most, high);
  }
  if (!Number.isFinite(least) || !Number.isFinite(most)) return;
  const reach = most - least || 1;
  const height = lane.height ?? HEIGHT;
  const y = (value: number) => top + height - 6 - ((value - least) / reach) * (height - 12);
  g.fillStyle = colours.violet;
  for (const { from, to, low, high } of lane.busy ?? []) g.fillRect(x(from), y(high) - 0.5, Math.max(x(to) - x(from), 1), y(low) - y(high) + 1);
  g.strokeStyle = colours.violet;
  g.lineWidth = 1.4;
  g.beginPath();
  let begun = false;
  for (const [edge, until] of inSight(lane, span)) {
    if (Number.isNaN(edge[1])) {
      begun = false;
      continue;
    }
    if (begun) g.lineTo(x(edge[0]), y(edge[1]));
    else g.moveTo(x(edge[0]), y(edge[1]));
    begun = true;
    // A value that lasted long is drawn level, not as a slope to the next.
    if (until - edge[0] > (span.to - span.from) / 60) g.lineTo(x(Math.min(until, now)), y(edge[1]));
  }
  g.stroke();
}

function inSpan(ms: number | null | undefined, span: Span): ms is number {
  return ms !== null && ms !== undefined && ms >= span.from && ms <= span.to;
}

function cursors(g: CanvasRenderingContext2D, { height, cursors, colours, now, seen, span }: Painting, x: X): void {
  if (now > span.from && now < span.to) {
    g.strokeStyle = colours.soft;
    g.setLineDash([2, 3]);
    line(g, Math.round(x(now)) + 0.5, 0, Math.round(x(now)) + 0.5, height);
    g.setLineDash([]);
  }
  if (inSpan(seen, span)) {
    g.strokeStyle = colours.accent;
    g.lineWidth = 2;
    line(g, Math.round(x(seen)) + 0.5, 0, Math.round(x(seen)) + 0.5, height);
  }
  cursors.forEach((ms, i) => {
    if (!inSpan(ms, span)) return;
    g.strokeStyle = i === 0 ? colours.amber : colours.violet;
    g.lineWidth = 1.5;
    line(g, Math.round(x(ms)) + 0.5, 0, Math.round(x(ms)) + 0.5, height);
  });
}
