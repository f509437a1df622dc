// True for a page in a frame of another page (`?embed`): it shows one file, keeps nothing in the browser, and leaves out
// what belongs to a window of its own.
const wishes = new URL(location.href).searchParams;

export const embedded = wishes.has('embed');

/** The wish of the frame for a setting, if it is one of the values that there are. */
export function wished<T extends string>(name: string, values: readonly T[]): T | undefined {
  const value = embedded ? wishes.get(name) : null;
  return values.find((one) => one === value);
}
