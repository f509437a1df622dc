// The pictures of plants that were drawn in this window: whoever shows one reads it again when it was saved.
import { SvelteMap } from 'svelte/reactivity';

const versions = new SvelteMap<string, number>();

/** The number of times that the picture of this path was saved; who reads it follows it. */
export const savedTimes = (path: string): number => versions.get(path) ?? 0;

export const wasSaved = (path: string): void => void versions.set(path, savedTimes(path) + 1);
