// The Rust crate `g7-page` as wasm in a worker: one JSON message in, one out, in the order of the
// requests. The worker keeps parsing, layout and runs off the painting thread.
//
// There are two modules of it (decision 55). The first shows, edits and runs charts. What it does not contain
// it says itself: it answers with the files that the question is about, and a worker with the second module,
// the whole program, is asked.
import { untrack } from 'svelte';

import { t } from './i18n';
import { link } from './link.svelte';
import { prefs } from './prefs.svelte';
import type { Answers, Frame, Requests } from './protocol';

/** The name of a message. */
export type Name = keyof Requests;

/** A message with this name, or with one of these names. */
export type Message<N extends Name = Name> = { [K in N]: { do: K } & Requests[K] }[N];

/** The messages to a run. */
export type RunName = Extract<Name, `run_${string}`>;

/** Without a run's name: those that a frame answers. */
export type Move = { [K in RunName]: Answers[K] extends Frame ? { do: K } & Omit<Requests[K], 'run'> : never }[RunName];

/** A refusal: a sentence for the user. */
export class Refused extends Error {}

/** A receiver of messages to runs: the page's own worker, or the server. The type of the answer follows from the
 * name of the message. */
export interface Door {
  call<N extends RunName>(message: { do: N } & Message<N>): Promise<Answers[N]>;
}

/** The module that is loaded at once, and the whole program. */
export type Module = 'g7.wasm' | 'g7-whole.wasm';

/** What the first module says of a question that the second one answers. */
interface Elsewhere {
  /** The message by which it is asked. */
  as: 'about' | 'import';
  files: { file: string; text: string }[];
}

interface Waiting {
  message: object;
  resolve(value: unknown): void;
  reject(reason: Error): void;
}

/** The value of an answer; throws if it is a refusal. */
export function opened<T>(answer: string): T {
  const said = JSON.parse(answer) as { ok?: T; no?: string };
  if (said.no !== undefined) throw new Refused(said.no);
  return said.ok as T;
}

/** The begin of an answer that sends to the second module. */
const ELSEWHERE = '{"elsewhere":';
/** The answer of a worker that could not get its module. */
const ABSENT = '{"absent":true}';

/** A worker with the wasm; it starts with the first message. */
export class Local implements Door {
  #worker: Worker | undefined;
  #waiting: Waiting[] = [];
  /** The language that the worker was told. */
  #language = 'en';
  /** A worker with the second module, once a question has needed it. */
  #whole: Local | undefined;

  constructor(readonly module: Module = 'g7.wasm') {}

  call<N extends Name>(message: { do: N } & Message<N>): Promise<Answers[N]> {
    return this.#ask(message) as Promise<Answers[N]>;
  }

  #ask(message: object): Promise<unknown> {
    // Whoever answers now may be a stranger, so nothing is loaded from there (decision 71).
    if (!this.#worker && untrack(() => link.state) !== 'up') return Promise.reject(new Refused(t('gone.part')));
    const worker = (this.#worker ??= this.#start());
    const language = untrack(() => prefs.language);
    if (this.#language !== language) {
      this.#language = language;
      worker.postMessage({ speak: language });
    }
    return new Promise((resolve, reject) => {
      this.#waiting.push({ message, resolve, reject });
      worker.postMessage(JSON.stringify(message));
    });
  }

  #start(): Worker {
    const worker = new Worker(new URL('./page.worker.ts', import.meta.url), { type: 'module' });
    worker.postMessage({ wasm: new URL(this.module, document.baseURI).href });
    worker.onmessage = (event: MessageEvent<string>) => {
      const waiting = this.#waiting.shift();
      if (event.data === ABSENT) {
        waiting?.reject(new Refused(t('gone.part')));
        return;
      }
      try {
        // The text is looked at first: a drawing is long, and is not to be parsed twice.
        const there = event.data.startsWith(ELSEWHERE) ? (JSON.parse(event.data) as { elsewhere: Elsewhere }).elsewhere : null;
        waiting?.resolve(there ? this.#elsewhere(waiting.message, there) : opened(event.data));
      } catch (error) {
        waiting?.reject(error as Error);
      }
    };
    worker.onerror = (event) => this.stop(event.message);
    return worker;
  }

  /** Asks the second module. What it has converted, the first one opens. */
  async #elsewhere(ask: object, { as, files }: Elsewhere): Promise<unknown> {
    this.#whole ??= new Local('g7-whole.wasm');
    const answer = await this.#whole.#ask({ between: as, files, ask });
    return as === 'import' ? this.#ask(answer as object) : answer;
  }

  /** Ends the worker, whatever it is doing; all messages under way fail, and its files are gone. */
  stop(why = ''): void {
    const waiting = this.#waiting.splice(0);
    this.#worker?.terminate();
    this.#worker = undefined;
    this.#whole?.stop(why);
    this.#language = 'en';
    waiting.forEach((w) => w.reject(new Error(why || 'the worker stopped')));
  }
}

export const page = new Local();
