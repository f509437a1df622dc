// Holds the wasm module: writes each message into its memory and reads the answer.

interface Door {
  memory: WebAssembly.Memory;
  g7_reserve(length: number): number;
  g7_call(): number;
  g7_answer(): number;
}

let door: Promise<Door> | undefined;
const encoder = new TextEncoder();
const decoder = new TextDecoder();

async function load(address: string): Promise<Door> {
  const answer = await fetch(address);
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
    door = load(said.wasm);
    return;
  }
  turn = turn.then(async () => {
    try {
      if (!door) throw new Error('no module');
      if (typeof said === 'string') self.postMessage(ask(await door, said));
      else await speak(await door, said.speak);
    } catch (error) {
      // Whoever chose a language waits for no answer.
      if (typeof said === 'string') self.postMessage(JSON.stringify({ no: `The program in the page failed: ${(error as Error).message}` }));
    }
  });
};
