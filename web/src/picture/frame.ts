// Where an object stands on the sheet: its frame is the `transform` of a group of its own, so that what is in the group is
// never touched. Middle, size and angle are what the user sees; the transform is what the file says.

/** An object's place on the sheet, in units of the picture; the angle in degrees, clockwise. */
export interface Place {
  cx: number;
  cy: number;
  w: number;
  h: number;
  angle: number;
}

/** A box without an angle. */
export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

export interface Frame {
  x: number;
  y: number;
  angle: number;
  sx: number;
  sy: number;
}

export const STILL: Frame = { x: 0, y: 0, angle: 0, sx: 1, sy: 1 };

const N = '(-?[\\d.]+(?:e-?\\d+)?)';
const FORM = new RegExp(`^translate\\(${N} ${N}\\)(?: rotate\\(${N}\\))?(?: scale\\(${N} ${N}\\))?$`);

/** A number with at most three digits behind its point. */
export const short = (n: number): number => Math.round(n * 1000) / 1000 + 0;

/** The frame that a transform says; null if the editor does not write such transforms. */
export function frameOf(transform: string | undefined): Frame | null {
  const found = FORM.exec(transform ?? '');
  if (!found) return null;
  const [, x, y, angle = '0', sx = '1', sy = '1'] = found;
  const frame = { x: Number(x), y: Number(y), angle: Number(angle), sx: Number(sx), sy: Number(sy) };
  return Object.values(frame).every(Number.isFinite) && frame.sx > 0 && frame.sy > 0 ? frame : null;
}

export function transformOf({ x, y, angle, sx, sy }: Frame): string {
  const turned = short(angle) === 0 ? '' : ` rotate(${short(angle)})`;
  const scaled = short(sx) === 1 && short(sy) === 1 ? '' : ` scale(${short(sx)} ${short(sy)})`;
  return `translate(${short(x)} ${short(y)})${turned}${scaled}`;
}

function turned(x: number, y: number, angle: number): [number, number] {
  const a = (angle * Math.PI) / 180;
  return [x * Math.cos(a) - y * Math.sin(a), x * Math.sin(a) + y * Math.cos(a)];
}

/** Where a frame puts a thing of this box. */
export function placeOf(frame: Frame, box: Box): Place {
  const [dx, dy] = turned((box.x + box.width / 2) * frame.sx, (box.y + box.height / 2) * frame.sy, frame.angle);
  return { cx: frame.x + dx, cy: frame.y + dy, w: box.width * Math.abs(frame.sx), h: box.height * Math.abs(frame.sy), angle: frame.angle };
}

/** The frame that puts a thing of this box to a place. */
export function framed(place: Place, box: Box): Frame {
  const scale = (wished: number, own: number) => (own > 1e-6 ? Math.max(0.02, wished / own) : 1);
  const [sx, sy] = [scale(place.w, box.width), scale(place.h, box.height)];
  const [dx, dy] = turned((box.x + box.width / 2) * sx, (box.y + box.height / 2) * sy, place.angle);
  return { x: place.cx - dx, y: place.cy - dy, angle: place.angle, sx, sy };
}

/** The upright box round a place. */
export function around({ cx, cy, w, h, angle }: Place): Box {
  const a = (angle * Math.PI) / 180;
  const width = Math.abs(w * Math.cos(a)) + Math.abs(h * Math.sin(a));
  const height = Math.abs(w * Math.sin(a)) + Math.abs(h * Math.cos(a));
  return { x: cx - width / 2, y: cy - height / 2, width, height };
}

/** The smallest box that holds all of these. */
export function union(boxes: readonly Box[]): Box {
  const x = Math.min(...boxes.map((b) => b.x));
  const y = Math.min(...boxes.map((b) => b.y));
  return { x, y, width: Math.max(...boxes.map((b) => b.x + b.width)) - x, height: Math.max(...boxes.map((b) => b.y + b.height)) - y };
}
