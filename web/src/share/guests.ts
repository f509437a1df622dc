// Pictures that came with a link, or were drawn where nothing can be saved. They are no files of the folder; the window keeps them as long as it is there.
const KEY = 'g7-guests';

function stored(): Record<string, string> {
  try {
    return JSON.parse(sessionStorage.getItem(KEY) ?? '{}') as Record<string, string>;
  } catch {
    return {};
  }
}

class Guests {
  #texts = new Map(Object.entries(stored()));

  find(name: string): string | undefined {
    return this.#texts.get(name);
  }

  put(name: string, text: string): void {
    this.#texts.set(name, text);
    this.#keep();
  }

  drop(name: string): void {
    if (this.#texts.delete(name)) this.#keep();
  }

  #keep(): void {
    try {
      sessionStorage.setItem(KEY, JSON.stringify(Object.fromEntries(this.#texts)));
    } catch {
      // Without storage, or where it is full, they are there until the page is loaded again.
    }
  }
}

export const guests = new Guests();
