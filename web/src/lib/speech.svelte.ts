// Messages to screen readers about changes that come by themselves: one region of the page, whose text changes about
// once a second at most. Several changes in that time are one message.

/** The least time between two messages, in ms. */
const GAP = 1200;

/** Makes a message when its turn has come; an empty one is left out. */
type Teller = () => string;

class Speech {
  said = $state('');
  #waiting = new Map<string, Teller>();
  #timer = 0;

  /** Has a message of a subject told; an earlier one of the same subject that still waits is dropped. */
  tell(subject: string, teller: Teller): void {
    this.#waiting.set(subject, teller);
    if (this.#timer === 0) this.#next();
  }

  /** Takes back what waits of a subject. */
  drop(subject: string): void {
    this.#waiting.delete(subject);
  }

  #next = (): void => {
    const texts = [...this.#waiting.values()].map((teller) => teller()).filter((text) => text !== '');
    this.#waiting.clear();
    this.#timer = 0;
    if (texts.length === 0) return;
    // Some texts are whole sentences.
    this.said = texts.map((text) => text.replace(/\.$/, '')).join('. ');
    this.#timer = window.setTimeout(this.#next, GAP);
  };
}

export const speech = new Speech();
