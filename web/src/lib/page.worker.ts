// Holds the wasm module: writes each message into its memory and reads the answer.

interface Door {
  memory: WebAssembly.Memory;
  g7_reserve(length: number): number;
  g7_call(): number;
  g7_answer(): number;
}

/** The answer where the module could not be fetched; `page.ts` knows it. */
const ABSENT = '{"absent":true}';

let address = '';
let door: Promise<Door> | undefined;
const encoder = new TextEncoder();
const decoder = new TextDecoder();

class Absent extends Error {}

/** The module, fetched at the begin. Where that failed, because the server was gone, the next message tries again. */
async function opened(): Promise<Door> {
  door ??= load();
  try {
    return await door;
  } catch (error) {
    door = undefined;
    throw error;
  }
}

async function load(): Promise<Door> {
  const answer = await fetch(address).catch(() => {
    throw new Absent();
  });
  if (!answer.ok) throw new Error(`g7.wasm: ${answer.status}`);
  // While it streams, it is compiled, and the browser keeps the compiled code for the next visit.
  const streams = answer.headers.get('content-type') === 'application/wasm';
  const module = await (streams ? WebAssembly.instantiateStreaming(answer, {}) : WebAssembly.instantiate(await answer.arrayBuffer(), {}));
  return module.instance.exports as unknown as Door;
}

function ask(door: Door, message: string): string {
  const bytes = encoder.encode(message);
  const at = door.g7_reserve(bytes.length);
  new Uint8Array(door.memory.buffer, at, bytes.length).set(bytes);
  const length = door.g7_call();
  return decoder.decode(new Uint8Array(door.memory.buffer, door.g7_answer(), length));
}

/** Tells the module the language of its answers. It contains the English texts alone; those in other languages
 * are fetched when the first of them is chosen. */
async function speak(door: Door, language: string): Promise<void> {
  const words = language === 'en' ? undefined : await import('./said').then((said) => said.texts).catch(() => undefined);
  ask(door, JSON.stringify({ do: 'speak', language, words }));
}

// Messages are processed one after the other, so that answers come in the order of the requests.
let turn: Promise<void> = Promise.resolve();

self.onmessage = (event: MessageEvent<string | { wasm: string } | { speak: string }>) => {
  const said = event.data;
  if (typeof said !== 'string' && 'wasm' in said) {
    address = said.wasm;
    opened().catch(() => undefined);
    return;
  }
  turn = turn.then(async () => {
    try {
      const door = await opened();
      if (typeof said === 'string') self.postMessage(ask(door, said));
      else await speak(door, said.speak);
    } catch (error) {
      // Whoever chose a language waits for no answer.
      if (typeof said === 'string') self.postMessage(error instanceof Absent ? ABSENT : JSON.stringify({ no: `The program in the page failed: ${(error as Error).message}` }));
    }
  });
};
