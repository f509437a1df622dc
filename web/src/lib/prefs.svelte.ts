// The user's choices, which the browser remembers.
import { embedded, wished } from './embedded';
import type { Language } from './i18n';
import { shape } from './shape.svelte';

export type Theme = 'auto' | 'light' | 'dark';

interface Kept {
  language: Language;
  theme: Theme;
  left: number;
  /** The width of the text that is read beside the editor. */
  reader: number;
  right: number;
  bottom: number;
  split: number;
  /** The share of the window that a sheet takes on a telephone. */
  sheet: number;
  leftOpen: boolean;
  rightOpen: boolean;
  bottomOpen: boolean;
  view: 'chart' | 'both' | 'text';
  look: 'iec60848' | 'sfc';
  pages: boolean;
  minimap: boolean;
  /** The view follows the steps that become active. */
  follow: boolean;
  guided: boolean;
  /** The address of the page that opens links; empty for this page. */
  place: string;
  /** The sheets of the print preview. */
  paper: 'a4' | 'a4-landscape' | 'a3' | 'a3-landscape';
  /** What the title block says of every chart. */
  author: string;
  /** The name that the others at a file see. */
  person: string;
  company: string;
}

const KEY = 'g7-prefs';

function spoken(): Language {
  const code = (navigator.language || 'en').slice(0, 2);
  return code === 'fr' || code === 'pt' ? code : 'en';
}

const first: Kept = {
  language: spoken(),
  theme: 'auto',
  left: 240,
  reader: 420,
  right: 300,
  bottom: 220,
  split: 0.5,
  sheet: 0.6,
  leftOpen: true,
  rightOpen: true,
  bottomOpen: false,
  view: 'chart',
  look: 'iec60848',
  pages: false,
  // It would cover the drawing of a telephone.
  minimap: !shape.phone,
  follow: false,
  guided: false,
  place: '',
  paper: 'a4',
  author: '',
  person: '',
  company: '',
};

/** In a frame there is little room, and its page chooses. */
function framed(): Partial<Kept> {
  return {
    language: wished('lang', ['en', 'fr', 'pt']) ?? spoken(),
    theme: wished('theme', ['auto', 'light', 'dark']) ?? 'auto',
    view: wished('view', ['chart', 'both', 'text']) ?? 'chart',
    look: wished('look', ['iec60848', 'sfc']) ?? 'iec60848',
    leftOpen: false,
    rightOpen: false,
    minimap: false,
  };
}

function stored(): Partial<Kept> {
  if (embedded) return framed();
  try {
    return JSON.parse(localStorage.getItem(KEY) ?? '{}') as Partial<Kept>;
  } catch {
    return {};
  }
}

export const prefs: Kept = $state({ ...first, ...stored() });

/** Stores the choices whenever they change; call once, inside a component. */
export function keepPrefs(): void {
  $effect(() => {
    if (embedded) return;
    const text = JSON.stringify(prefs);
    try {
      localStorage.setItem(KEY, text);
    } catch {
      // The page also works in a browser without storage.
    }
  });
  $effect(() => {
    document.documentElement.lang = prefs.language;
    document.documentElement.dataset.theme = prefs.theme;
  });
}
