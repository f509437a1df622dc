// The link of a file, made anew when the file changes: for the dialog, and for the way out of a frame.
import type { OpenFile } from '../lib/files.svelte';
import { shell } from '../lib/shell.svelte';
import { linkOf, parcelOf } from './parcels';

/** While somebody types, a new link is made after so long a pause, in ms. */
const PAUSE = 300;

export class Linked {
  /** The link from its `#` on: empty until it is made, null if the files are too large for one. */
  hash: string | null = $state('');
  /** The other files in it. */
  others: string[] = $state.raw([]);

  /** Follows a file; call inside a component. */
  constructor(of: () => OpenFile | null) {
    let pause = 0;
    $effect(() => {
      const file = of();
      void file?.text;
      if (!file) return;
      let old = false;
      const timer = setTimeout(() => void shell.try(() => this.#make(file, () => old)), pause);
      pause = PAUSE;
      return () => {
        old = true;
        clearTimeout(timer);
      };
    });
  }

  async #make(file: OpenFile, isOld: () => boolean): Promise<void> {
    const parcel = await parcelOf(file);
    const hash = await linkOf(parcel);
    if (isOld()) return;
    this.hash = hash;
    this.others = [...parcel.uses, ...parcel.pictures].map((leaf) => leaf.file);
  }
}
