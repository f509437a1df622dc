// Finds the place where an element over the drawing covers least of it.
import type { Box } from '../lib/protocol';
import type { Point } from './scene';

interface Room {
  /** The possible places of the upper left corner, the preferred ones first. */
  places: readonly Point[];
  size: readonly [w: number, h: number];
  within: Box;
  /** Boxes that should stay visible. */
  others: readonly Box[];
  /** The box of the symbol that the element belongs to: it is never covered. */
  about: Box;
  /** The cost of one px of distance, in px² of covered area. */
  far: number;
}

/** The area of the intersection of two boxes. */
function overlap([ax, ay, aw, ah]: Box, [bx, by, bw, bh]: Box): number {
  const w = Math.min(ax + aw, bx + bw) - Math.max(ax, bx);
  const h = Math.min(ay + ah, by + bh) - Math.max(ay, by);
  return w > 0 && h > 0 ? w * h : 0;
}

/** A place, and what it costs there. */
export interface Found {
  at: Point;
  cost: number;
}

/** The place of an element where it covers least. */
export const freest = (room: Room): Point => cheapest(room).at;

/** The same, with its cost. */
export function cheapest({ places, size: [w, h], within: [left, top, wide, high], others, about, far }: Room): Found {
  const [mx, my] = [about[0] + about[2] / 2, about[1] + about[3] / 2];
  let best: Point = [left, top];
  let least = Infinity;
  for (const [px, py] of places) {
    const x = Math.max(left, Math.min(px, left + wide - w));
    const y = Math.max(top, Math.min(py, top + high - h));
    const at: Box = [x, y, w, h];
    const covered = others.reduce((sum, other) => sum + overlap(at, other), 0);
    const cost = covered + far * Math.hypot(x + w / 2 - mx, y + h / 2 - my) + (overlap(at, about) > 0 ? 1e7 : 0);
    if (cost < least) {
      best = [x, y];
      least = cost;
    }
  }
  return { at: best, cost: least };
}
