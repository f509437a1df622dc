// Files and shared runs of `g7 serve`. Without a server (in the static playground) the examples
// come from one file beside the page, and nothing is written.
import type { Wishes } from '../operator/told';
import type { Draft, DraftRow, End } from './drafts.svelte';
import { here } from './here';
import { t } from './i18n';
import { link, type Linked } from './link.svelte';
import { opened, Refused, type Door, type Message, type RunName } from './page';
import type { Answers, Shelved, Splice, Started } from './protocol';
import { prefs } from './prefs.svelte';
import { ownToken, session } from './session.svelte';

export interface Info {
  name: string;
  version: string;
  read_only: boolean;
  folder: string;
  /** A name that no other folder has. */
  place: string;
  /** True if the server drives a machine. */
  online?: boolean;
  start?: string;
}

export interface FileRow {
  path: string;
  size: number;
  hash: string;
  title?: string;
}

export interface Changed {
  path: string;
  hash: string;
}

/** A run of the server, with its speed. */
export type Shared = Started & { speed: number };

/** Someone at a file that several people have open together. */
export interface Person {
  id: number;
  name: string;
  /** False for who only looks. */
  edits: boolean;
}

/** The place of a person: the chart, the pointer in its units, the selected symbols, the selection in the text. */
export interface Here {
  chart?: string;
  point?: [number, number];
  select?: string[];
  text?: [number, number];
}

/** A file at which people are; `edited` if its text is shared. */
export interface Table {
  file: string;
  edited: boolean;
  people: Person[];
}

/** The answer to whoever joins others at a file. */
export interface Joined {
  me: number;
  edits: boolean;
  version: number;
  /** The text that all have; null where nobody edits. */
  text: string | null;
  /** True if the change was made that the page had sent before its connection broke. */
  made: boolean;
  people: Person[];
  here: [number, Here][];
}

/** The messages that the server answers itself, and its answers (`crates/g7/src/serve`). */
interface Own extends Wishes {
  runs: { asked: object; told: { runs: { run: string; file: string; speed: number }[] } };
  watch: { asked: { run: string }; told: Shared };
  unwatch: { asked: { run: string }; told: null };
  pace: { asked: { run: string; speed: number }; told: { run: string; speed: number } };
  together_list: { asked: object; told: { tables: Table[] } };
  together_join: { asked: { file: string; name: string; text: string; edits: boolean; key: string | null }; told: Joined };
  together_leave: { asked: { file: string }; told: null };
  together_change: { asked: { file: string; version: number; splices: Splice[]; key: string }; told: { version: number } | { behind: true } };
  together_here: { asked: { file: string; here: Here }; told: null };
  together_saved: { asked: { file: string; tag: string }; told: null };
}

/** The messages that may bring the text of their file. */
interface WithText {
  run_start: Shared;
  run_swap: Answers['run_swap'];
}

/** The file was changed by someone else since it was read. */
export class Conflict extends Error {
  constructor(
    readonly text: string,
    readonly hash: string,
  ) {
    super('changed outside');
  }
}

/** There is no connection to the server. */
export class Gone extends Refused {
  constructor() {
    super(t('gone.now'));
  }
}

/** The code with which the server closes a connection whose session is over: the page asks anew who is there. */
const OVER = 4401;
/** The wait before the first try to come back, before the next ones, and for an answer, in ms. */
const SOON = 250;
const AGAIN = 1000;
const ANSWER = 5000;

class Server implements Door {
  info: Info | null = null;
  /** The files of the static playground. */
  #examples = new Map<string, string>();
  #token = ownToken();
  #socket: Promise<WebSocket> | null = null;
  /** The connection was lost, so whoever answers now may be another one: it is not told the token. */
  #lost = false;
  #trying = false;
  #waiting = new Map<number, { resolve(v: unknown): void; reject(e: Error): void }>();
  #next = 1;
  #heard = new Set<(message: Record<string, unknown>) => void>();
  #linked = new Set<(up: boolean) => void>();

  /** Finds out if there is a server; otherwise reads the examples. */
  async begin(): Promise<void> {
    try {
      const answer = await this.#fetch('api/info');
      if (answer.ok && answer.headers.get('content-type')?.includes('json')) {
        this.info = (await answer.json()) as Info;
        return;
      }
      if (answer.status === 401 || answer.status === 403) throw new Refused(await answer.text());
    } catch (error) {
      if (error instanceof Refused && !(error instanceof Gone)) throw error;
    }
    const answer = await fetch('./examples.json').catch(() => null);
    if (!answer?.ok) return;
    const found = (await answer.json()) as Record<string, string>;
    this.#examples = new Map(Object.entries(found));
  }

  get writes(): boolean {
    return this.info !== null && !this.info.read_only && session.may('engineer');
  }

  async files(): Promise<FileRow[]> {
    if (!this.info) {
      return [...this.#examples].map(([path, text]) => ({ path, size: text.length, hash: '' }));
    }
    const answer = await this.#ok(await this.#fetch('api/files'));
    return ((await answer.json()) as { files: FileRow[] }).files;
  }

  async read(path: string): Promise<{ text: string; hash: string }> {
    if (!this.info) {
      const text = this.#examples.get(path);
      if (text === undefined) throw new Refused(path);
      return { text, hash: '' };
    }
    const answer = await this.#ok(await this.#fetch(`api/file?path=${encodeURIComponent(path)}`));
    return { text: await answer.text(), hash: tag(answer) };
  }

  /** Writes a file completely; throws [`Conflict`] if it has changed since it was read. */
  async write(path: string, text: string, hash: string | null): Promise<string> {
    const headers: Record<string, string> = { 'content-type': 'text/plain; charset=utf-8' };
    if (hash === null) headers['if-none-match'] = '*';
    else headers['if-match'] = `"${hash}"`;
    const answer = await this.#fetch(`api/file?path=${encodeURIComponent(path)}`, {
      method: 'PUT',
      headers,
      body: text,
    });
    if (answer.status === 412) throw new Conflict(await answer.text(), tag(answer));
    await this.#ok(answer);
    return tag(answer);
  }

  /** Keeps the copy of this window. */
  async keepDraft(path: string, { text, base }: Omit<Draft, 'path'>, end: End): Promise<void> {
    const from: Record<string, string> = { path, end };
    if (base !== null) from.base = base;
    await this.#ok(await this.#fetch(this.#draft('', from), { method: 'PUT', body: text }));
  }

  async drafts(): Promise<DraftRow[]> {
    if (!this.info) return [];
    const { drafts } = await this.ask<{ drafts: Omit<DraftRow, 'kept'>[] }>(this.#draft('s'));
    return drafts.map((row) => ({ ...row, kept: 'server' }));
  }

  draft(id: string): Promise<Draft> {
    return this.ask(this.#draft('', { id }));
  }

  async takeDraft(id: string): Promise<Draft> {
    return (await (await this.#ok(await this.#post(this.#draft('/take', { id }), {}))).json()) as Draft;
  }

  async savedDraft(path: string): Promise<void> {
    await this.#ok(await this.#post(this.#draft('/saved', { path }), {}));
  }

  async dropDraft(id: string): Promise<void> {
    await this.#ok(await this.#fetch(this.#draft('', { id }), { method: 'DELETE' }));
  }

  #draft(what: string, asks: Record<string, string> = {}): string {
    return `api/draft${what}?${new URLSearchParams({ window: here, ...asks }).toString()}`;
  }

  /** Renames, deletes or creates a file. */
  async change(what: 'rename' | 'delete' | 'new', body: Record<string, string>): Promise<void> {
    await this.#ok(await this.#post(`api/${what}`, body));
  }

  async #post(path: string, body: unknown): Promise<Response> {
    return this.#fetch(path, { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) });
  }

  /** Asks for the wiring of a chart, or for the values at its devices. */
  async wiring<T>(what: 'look' | 'live', chart: { path: string; text: string }): Promise<T> {
    return (await (await this.#ok(await this.#post(`api/wiring/${what}`, chart))).json()) as T;
  }

  /** Changes the io file of a chart. Where it has changed since it was read, nothing is done; both times
   * the present wiring comes back. */
  async wiringEdit<T>(body: unknown): Promise<{ done: boolean; told: T }> {
    const answer = await this.#post('api/wiring/edit', body);
    if (answer.status !== 412) await this.#ok(answer);
    return { done: answer.ok, told: (await answer.json()) as T };
  }

  /** Asks the server for an answer in JSON. */
  async ask<T>(path: string): Promise<T> {
    return (await (await this.#ok(await this.#fetch(path))).json()) as T;
  }

  /** Asks the server for a file. */
  async bytes(path: string): Promise<ArrayBuffer> {
    return (await this.#ok(await this.#fetch(path))).arrayBuffer();
  }

  /** Calls a listener with every message that the server sends on its own: frames, changed files.
   * */
  hear(listener: (message: Record<string, unknown>) => void): () => void {
    this.#heard.add(listener);
    if (this.info) void this.#live().catch(() => undefined);
    return () => this.#heard.delete(listener);
  }

  /** Calls a listener whenever the connection is there or lost. */
  link(listener: (up: boolean) => void): () => void {
    this.#linked.add(listener);
    return () => this.#linked.delete(listener);
  }

  /** Sends a message to a shared run, or to the server itself. */
  call<N extends keyof WithText>(message: { do: N; text: string; uses: Shelved[] } & Message<N>): Promise<WithText[N]>;
  call<N extends RunName>(message: { do: N } & Message<N>): Promise<Answers[N]>;
  call<N extends keyof Own>(message: { do: N } & Own[N]['asked']): Promise<Own[N]['told']>;
  async call(message: object): Promise<unknown> {
    const socket = await this.#live();
    const id = this.#next++;
    return new Promise((resolve, reject) => {
      this.#waiting.set(id, { resolve, reject });
      socket.send(JSON.stringify({ id, call: message }));
    });
  }

  #live(): Promise<WebSocket> {
    if (this.#lost) return Promise.reject(new Gone());
    this.#socket ??= this.#connect();
    return this.#socket;
  }

  #connect(): Promise<WebSocket> {
    return new Promise((resolve, reject) => {
      const address = new URL('api/live', document.baseURI);
      address.protocol = address.protocol === 'https:' ? 'wss:' : 'ws:';
      address.searchParams.set('token', this.#token);
      address.searchParams.set('window', here);
      address.searchParams.set('language', prefs.language);
      const socket = new WebSocket(address);
      socket.onopen = () => {
        link.state = 'up';
        resolve(socket);
        this.#linked.forEach((listener) => listener(true));
      };
      socket.onmessage = (event: MessageEvent<string>) => this.#hear(event.data);
      socket.onclose = (event) => {
        if (event.code === OVER) location.reload();
        this.#socket = null;
        reject(new Gone());
        this.#waiting.forEach((w) => w.reject(new Gone()));
        this.#waiting.clear();
        this.#linked.forEach((listener) => listener(false));
        void this.#back();
      };
    });
  }

  /** Tries to come back until the server of before is there again. */
  async #back(): Promise<void> {
    if (this.#trying) return;
    this.#trying = this.#lost = true;
    for (let wait = SOON, there = false; !there; wait = AGAIN) {
      await new Promise((done) => setTimeout(done, wait * (1 + Math.random() / 2)));
      const found = await this.#found();
      this.#lost = found !== 'up';
      if (this.#lost) link.state = found;
      else there = await (this.#socket ??= this.#connect()).then(() => true, () => false);
    }
    this.#trying = false;
  }

  /** Who is there now. */
  async #found(): Promise<Linked> {
    try {
      // A user has a cookie and no token, and the server a certificate.
      if (!session.told.users && !(await this.#proves())) return 'strange';
      const answer = await this.#ask('api/info', { signal: AbortSignal.timeout(ANSWER) });
      if (answer.status === 401 && session.told.users) location.reload();
      if (!known(answer)) return 'strange';
      const info = (await answer.json()) as Info;
      if (info.place !== this.info?.place) return 'other';
      if (info.version !== this.info.version) return 'newer';
      this.info = info;
      return 'up';
    } catch {
      return 'gone';
    }
  }

  /** True if whoever answers knows the token without being told it (decision 71). */
  async #proves(): Promise<boolean> {
    // Browsers have no hashes in a page of plain HTTP, such as a frame in one: there nothing can be proved.
    if (!(crypto.subtle as SubtleCrypto | undefined)) return true;
    const number = hex(crypto.getRandomValues(new Uint8Array(16)));
    const address = new URL(`api/again?number=${number}`, document.baseURI);
    const answer = await fetch(address, { signal: AbortSignal.timeout(ANSWER) });
    if (!known(answer)) return false;
    const { proofs } = (await answer.json()) as { proofs?: string[] };
    const port = address.port || (address.protocol === 'https:' ? '443' : '80');
    return proofs?.includes(await hash(`${await hash(this.#token)}:${port}:${number}`)) ?? false;
  }

  #hear(text: string): void {
    const message = JSON.parse(text) as Record<string, unknown>;
    const waiting = this.#waiting.get(message.id as number);
    if (!waiting) {
      this.#heard.forEach((listener) => listener(message));
      return;
    }
    this.#waiting.delete(message.id as number);
    try {
      waiting.resolve(opened(JSON.stringify(message.answer)));
    } catch (error) {
      waiting.reject(error as Error);
    }
  }

  async #fetch(path: string, init: RequestInit = {}): Promise<Response> {
    if (this.#lost) throw new Gone();
    try {
      return await this.#ask(path, init);
    } catch {
      throw new Gone();
    }
  }

  #ask(path: string, init: RequestInit): Promise<Response> {
    const headers = {
      ...(init.headers as Record<string, string>),
      'accept-language': prefs.language,
      authorization: `Bearer ${this.#token}`
    };
    return fetch(new URL(path, document.baseURI), { ...init, headers });
  }

  async #ok(answer: Response): Promise<Response> {
    if (answer.status === 401 && session.told.users) location.reload();
    if (!answer.ok) throw new Refused((await answer.text()) || answer.statusText);
    return answer;
  }
}

/** False if a server refuses what that of before answers; throws if it has no time to answer. */
function known(answer: Response): boolean {
  if (answer.status === 429 || answer.status >= 500) throw new Gone();
  return answer.ok;
}

function tag(answer: Response): string {
  return (answer.headers.get('etag') ?? '').replace(/^W\//, '').replaceAll('"', '');
}

function hex(bytes: Uint8Array): string {
  return [...bytes].map((byte) => byte.toString(16).padStart(2, '0')).join('');
}

async function hash(text: string): Promise<string> {
  return hex(new Uint8Array(await crypto.subtle.digest('SHA-256', new TextEncoder().encode(text))));
}

export const server = new Server();
