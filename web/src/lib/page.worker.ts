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

// Messages are processed one after the other, so that answers come in the order of the requests.
let turn: Promise<void> = Promise.resolve();

self.onmessage = (event: MessageEvent<string | { wasm: string }>) => {
  const said = event.data;
  if (typeof said !== 'string') {
    door = load(said.wasm);
    return;
  }
  turn = turn.then(async () => {
    let answer: string;
    try {
      if (!door) throw new Error('no module');
      answer = ask(await door, said);
    } catch (error) {
      answer = JSON.stringify({ no: `The program in the page failed: ${(error as Error).message}` });
    }
    self.postMessage(answer);
  });
};
