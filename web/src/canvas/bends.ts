// The bends of a link: which of its segments can be moved, and the bends that the text is given for the moved line.
import type { Item } from '../lib/protocol';
import type { Point } from './scene';

/** A segment of a link that can be moved. */
export interface Segment {
  /** The number of the corner at which it begins. */
  index: number;
  /** True if it runs up or down, and is moved sideways. */
  upright: boolean;
  middle: Point;
}

/** The segments of a line that can be moved: those between the parts that the layout holds. */
export function segmentsOf({ held }: Item, line: readonly Point[]): Segment[] {
  if (!held) return [];
  const found: Segment[] = [];
  for (let index = held[0]; index < line.length - 1 - held[1]; index++) {
    const [[ax, ay], [bx, by]] = [line[index] as Point, line[index + 1] as Point];
    found.push({ index, upright: ax === bx, middle: [(ax + bx) / 2, (ay + by) / 2] });
  }
  return found;
}

/** A line of which one segment is moved. */
export function moved(line: readonly Point[], { index, upright }: Segment, by: number): Point[] {
  return line.map(([x, y], n): Point => {
    if (n !== index && n !== index + 1) return [x, y];
    return upright ? [x + by, y] : [x, y + by];
  });
}

/** The bends of a line: for each part that goes sideways its height, and the place at which it ends. */
export function bendsOf({ held }: Item, line: readonly Point[]): Point[] {
  if (!held) return [];
  return line.slice(held[0], line.length - held[1]).filter((_, n) => n % 2 === 1);
}
