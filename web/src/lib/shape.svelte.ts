// The shape of the window. On a telephone the bars are short, the panels are sheets over the drawing, and the
// keyboard of the screen takes room from the page.
import { MediaQuery } from 'svelte/reactivity';

const narrow = new MediaQuery('(max-width: 560px)');
const coarse = new MediaQuery('(pointer: coarse)');
const low = new MediaQuery('(max-height: 480px) and (pointer: coarse)');

/** A keyboard hides more of the window than this, in px; the bars of a browser hide less. */
const KEYBOARD = 120;

/** The three regions that can be opened. */
export type Region = 'left' | 'right' | 'bottom';

class Shape {
  /** The visible height and its beginning, in px, while a keyboard covers the rest. */
  keys: { height: number; top: number } | null = $state.raw(null);

  get phone(): boolean {
    return narrow.current || low.current;
  }

  /** True if fingers press the page. */
  get fingers(): boolean {
    return coarse.current;
  }

  /** True for a telephone that lies on its side: width is plenty, height is not. */
  get lying(): boolean {
    return low.current && !narrow.current;
  }

  /** Follows the keyboard of the screen; returns what ends that. */
  follow(): () => void {
    const seen = window.visualViewport;
    if (!seen) return () => undefined;
    const look = () => {
      // A page that is enlarged shows less of itself too; it has no keyboard for that.
      const covered = window.innerHeight - seen.height * seen.scale;
      this.keys = covered > KEYBOARD && seen.scale <= 1.01 ? { height: seen.height, top: seen.offsetTop } : null;
    };
    look();
    seen.addEventListener('resize', look);
    seen.addEventListener('scroll', look);
    return () => {
      seen.removeEventListener('resize', look);
      seen.removeEventListener('scroll', look);
    };
  }
}

export const shape = new Shape();
