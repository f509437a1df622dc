// The room at the edges of the drawing that the elements over it take: the palette, the path of charts, the buttons
// of the zoom. In px.
import { shape } from '../lib/shape.svelte';

interface Margins {
  left: number;
  right: number;
  top: number;
  low: number;
}

const DESK: Margins = { left: 64, right: 64, top: 58, low: 40 };
/** The palette lies along the lower edge, the zoom at the right. */
const PHONE: Margins = { left: 12, right: 58, top: 54, low: 64 };

export const margins = (): Margins => (shape.phone ? PHONE : DESK);
