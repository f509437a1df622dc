// A part or a variable on its way to the sheet, under a mouse or a finger.

/** A drag begins here, in px; less is a click. */
const BEGINS = 5;

export interface Dragged<T> {
  what: T;
  x: number;
  y: number;
}

/** Follows a press on something that can be dragged. `move` hears where it is, `drop` where it was let go; a press that
 * does not move stays a click. A finger that moves along its list scrolls that. */
export function dragging<T>(e: PointerEvent, what: T, move: (at: Dragged<T> | null) => void, drop: (at: Dragged<T>) => void): void {
  if (e.button !== 0) return;
  const source = e.currentTarget as HTMLElement;
  const ended = new AbortController();
  const listen = { signal: ended.signal };
  let going = false;
  window.addEventListener(
    'pointermove',
    (now) => {
      if (now.pointerId !== e.pointerId) return;
      if (!going && Math.hypot(now.clientX - e.clientX, now.clientY - e.clientY) < BEGINS) return;
      if (!going) source.setPointerCapture(e.pointerId);
      going = true;
      now.preventDefault();
      move({ what, x: now.clientX, y: now.clientY });
    },
    listen,
  );
  const end = (now: PointerEvent) => {
    if (now.pointerId !== e.pointerId) return;
    ended.abort();
    move(null);
    if (!going) return;
    // The click that follows a drag is none.
    source.addEventListener('click', (click) => click.stopImmediatePropagation(), { capture: true, once: true, signal: AbortSignal.timeout(50) });
    if (now.type === 'pointerup') drop({ what, x: now.clientX, y: now.clientY });
  };
  window.addEventListener('pointerup', end, listen);
  window.addEventListener('pointercancel', end, listen);
}
