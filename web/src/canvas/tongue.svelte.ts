// The language in which logic is shown beside the drawing; one choice for all symbols.
import type { Tongue } from '../lib/protocol';

export const tongue: { now: Tongue } = $state({ now: 'st' });
