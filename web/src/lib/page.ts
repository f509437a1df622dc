// The Rust crate `g7-page` as wasm in a worker: one JSON message in, one out, in the order of the
// requests. The worker keeps parsing, layout and runs off the painting thread.
import { untrack } from 'svelte';

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

interface Waiting {
  resolve(value: unknown): void;
  reject(reason: Error): void;
}

/** The value of an answer; throws if it is a refusal. */
export function opened<T>(answer: string): T {
  const said = JSON.parse(answer) as { ok?: T; no?: string };
  if (said.no !== undefined) throw new Refused(said.no);
  return said.ok as T;
}

/** A worker with the wasm; it starts with the first message. */
export class Local implements Door {
  #worker: Worker | undefined;
  #waiting: Waiting[] = [];
  /** The language that the worker was told. */
  #language = 'en';

  call<N extends Name>(message: { do: N } & Message<N>): Promise<Answers[N]> {
    this.#worker ??= this.#start();
    const language = untrack(() => prefs.language);
    if (this.#language !== language) {
      this.#language = language;
      void this.#send({ do: 'speak', language });
    }
    return this.#send(message);
  }

  #send<N extends Name>(message: { do: N } & Message<N>): Promise<Answers[N]> {
    const answer = new Promise<Answers[N]>((resolve, reject) => {
      this.#waiting.push({ resolve: resolve as (value: unknown) => void, reject });
    });
    this.#worker?.postMessage(JSON.stringify(message));
    return answer;
  }

  #start(): Worker {
    const worker = new Worker(new URL('./page.worker.ts', import.meta.url), { type: 'module' });
    worker.postMessage({ wasm: new URL('g7.wasm', document.baseURI).href });
    worker.onmessage = (event: MessageEvent<string>) => {
      const waiting = this.#waiting.shift();
      try {
        waiting?.resolve(opened(event.data));
      } catch (error) {
        waiting?.reject(error as Error);
      }
    };
    worker.onerror = (event) => this.stop(event.message);
    return worker;
  }

  /** Ends the worker, whatever it is doing; all messages under way fail, and its files are gone. */
  stop(why = ''): void {
    const waiting = this.#waiting.splice(0);
    this.#worker?.terminate();
    this.#worker = undefined;
    this.#language = 'en';
    waiting.forEach((w) => w.reject(new Error(why || 'the worker stopped')));
  }
}

export const page = new Local();
