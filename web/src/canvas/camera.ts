// The view of the drawing: d3-zoom for dragging and pinching, the wheel for moving.
import { select } from 'd3-selection';
import { zoom, zoomIdentity, type D3ZoomEvent, type ZoomBehavior } from 'd3-zoom';
import type { Box } from '../lib/protocol';
import type { View } from './editor.svelte';
import { margins } from './margins';

const LEAST = 0.02;
const MOST = 4;

export class Camera {
  #root: HTMLElement;
  #zoom: ZoomBehavior<HTMLElement, unknown>;
  #area: () => Box;

  /** `mayPan` says if a press on the drawing moves the view. */
  constructor(root: HTMLElement, area: () => Box, mayPan: (e: MouseEvent | TouchEvent) => boolean, moved: (view: View) => void) {
    this.#root = root;
    this.#area = area;
    this.#zoom = zoom<HTMLElement, unknown>()
      .scaleExtent([LEAST, MOST])
      .filter((e: MouseEvent | TouchEvent | WheelEvent) => {
        if (e.type === 'wheel') return (e as WheelEvent).ctrlKey || (e as WheelEvent).metaKey;
        if (e.type === 'dblclick') return false;
        return mayPan(e as MouseEvent);
      })
      .wheelDelta((e: WheelEvent) => -e.deltaY * (e.deltaMode === 1 ? 0.05 : 0.004))
      .on('zoom', (e: D3ZoomEvent<HTMLElement, unknown>) => {
        const { x, y, k } = e.transform;
        moved({ x, y, k });
      });
    select(root).call(this.#zoom).on('dblclick.zoom', null);
    root.addEventListener('wheel', this.#wheel, { passive: false });
  }

  #wheel = (e: WheelEvent): void => {
    e.preventDefault();
    if (e.ctrlKey || e.metaKey) return;
    const size = e.deltaMode === 1 ? 24 : 1;
    const [dx, dy] = e.shiftKey && e.deltaX === 0 ? [e.deltaY, 0] : [e.deltaX, e.deltaY];
    this.panBy(-dx * size, -dy * size);
  };

  /** Moves the view by px of the screen. */
  panBy(dx: number, dy: number): void {
    const k = this.#scale();
    select(this.#root).call(this.#zoom.translateBy, dx / k, dy / k);
  }

  zoomBy(factor: number): void {
    select(this.#root).call(this.#zoom.scaleBy, factor);
  }

  set(view: View): void {
    select(this.#root).call(this.#zoom.transform, zoomIdentity.translate(view.x, view.y).scale(view.k));
  }

  /** Puts a point of the plane into the middle. */
  moveTo(x: number, y: number): void {
    select(this.#root).call(this.#zoom.translateTo, x, y);
  }

  /** The size of the sheet without what lies over its edges. */
  #room(): { left: number; top: number; w: number; h: number } {
    const { clientWidth, clientHeight } = this.#root;
    const { left, right, top, low } = margins();
    return { left, top, w: Math.max(clientWidth - left - right, 1), h: Math.max(clientHeight - top - low, 1) };
  }

  /** Shows the whole chart. */
  fit(most = 1.5): void {
    const { left, top, w, h } = this.#room();
    const [ax, ay, aw, ah] = this.#area();
    const k = Math.min(most, w / Math.max(aw, 1), h / Math.max(ah, 1));
    // A chart of thousands of steps is smaller than the wheel makes it.
    this.#zoom.scaleExtent([Math.min(LEAST, k), MOST]);
    this.set({ k, x: left + w / 2 - (ax + aw / 2) * k, y: top + h / 2 - (ay + ah / 2) * k });
  }

  /** The first view: the whole chart if it is readable, otherwise its beginning. */
  begin(first: Box): void {
    const { left, top, w, h } = this.#room();
    const [ax, ay, aw, ah] = this.#area();
    const all = Math.min(w / Math.max(aw, 1), h / Math.max(ah, 1));
    if (all >= 0.6) {
      this.fit(1);
      return;
    }
    const k = Math.max(0.6, Math.min(1, w / Math.max(aw, 1)));
    const [from, to] = [left - ax * k, left + w - (ax + aw) * k];
    const middle = left + w / 2 - (first[0] + first[2] / 2) * k;
    const x = to >= from ? left + w / 2 - (ax + aw / 2) * k : Math.max(to, Math.min(from, middle));
    const far = (first[1] - ay) * k > h / 2;
    this.set({ k, x, y: top - (far ? first[1] - 60 : ay) * k });
  }

  reveal(box: Box, centre = false): void {
    const t = this.#transform();
    const { clientWidth: w, clientHeight: h } = this.#root;
    const [x, y] = [box[0] * t.k + t.x, box[1] * t.k + t.y];
    const [right, low] = [x + box[2] * t.k, y + box[3] * t.k];
    // Below a symbol stands the handle for its links.
    const [edge, beneath] = [50, Math.max(50, margins().low + 12)];
    if (!centre && x >= edge && y >= edge && right <= w - edge && low <= h - beneath) {
      // The overview covers its corner.
      const map = this.#root.parentElement?.querySelector('.map')?.getBoundingClientRect();
      const top = map ? map.top - this.#root.getBoundingClientRect().top : h;
      if (map && right > w - map.width - 12 && low > top) this.panBy(0, Math.max(top - edge - low, edge - y));
      return;
    }
    if (centre || x > w || right < 0 || y > h || low < 0) {
      this.moveTo(box[0] + box[2] / 2, box[1] + box[3] / 2);
      return;
    }
    const by = (from: number, to: number, last: number) => (from < edge ? edge - from : to > last ? Math.max(last - to, edge - from) : 0);
    this.panBy(by(x, right, w - edge), by(y, low, h - beneath));
  }

  focus(): void {
    this.#root.focus({ preventScroll: true });
  }

  drop(): void {
    this.#root.removeEventListener('wheel', this.#wheel);
    select(this.#root).on('.zoom', null);
  }

  #transform(): View {
    return (this.#root as unknown as { __zoom: View }).__zoom;
  }

  #scale(): number {
    return this.#transform().k;
  }
}
