// A file that several people have open together: the order of its changes, who is there, and where they are (decision 086).
//
// The server takes a change that was made on its newest version and tells it to all others. So a page sends one change at
// a time; what is typed meanwhile waits, and a change of somebody else is moved over what is not confirmed yet. All pages then have the
// same text, whatever came first.
import { ChangeSet } from '@codemirror/state';
import { apply, asSpecs, asSplices, between, crossed, type OpenFile, type TextChange } from '../lib/files.svelte';
import { here } from '../lib/here';
import type { Splice } from '../lib/protocol';
import { Gone, server, type Here, type Person } from '../lib/server';

/** A change as the server tells it. */
export interface Made {
  version: number;
  by: number;
  splices: Splice[];
}

/** Keys of changes are those of this page: its window, its begin, and a number. */
const BEGAN = Date.now();
let keys = 0;

/** Both changes as one, the second behind the first. */
const composed = (a: ChangeSet | null, b: ChangeSet | null) => (a && b ? a.compose(b) : (a ?? b));

/** The number of units by which splices make a text longer. */
const growth = (splices: Splice[]) => splices.reduce((sum, s) => sum + s.insert.length - (s.to - s.from), 0);

export class Gathering {
  readonly file: OpenFile;
  me = $state(0);
  /** False for who only looks. */
  edits = $state(false);
  people: readonly Person[] = $state.raw([]);
  here: ReadonlyMap<number, Here> = $state.raw(new Map());
  /** The text that all have, if there is one. */
  #confirmed: string | null = null;
  #version = 0;
  /** The change that the server was asked to make, with its key; and what was changed here since. */
  #sent: { changes: ChangeSet; key: string } | null = null;
  #waiting: ChangeSet | null = null;
  #ready = false;
  #stop: () => void;

  constructor(file: OpenFile) {
    this.file = file;
    this.#stop = file.listen((change) => this.#changed(change));
  }

  readonly others: readonly Person[] = $derived(this.people.filter((p) => p.id !== this.me));

  /** True if this page is the one that takes over what other programs write: the first one that edits. */
  get first(): boolean {
    return this.people.find((p) => p.edits)?.id === this.me;
  }

  /** Joins those at the file, or comes back to them with what was changed here meanwhile. */
  async join(name: string, edits: boolean): Promise<void> {
    this.#ready = false;
    const text = this.file.text;
    const [sent, waited] = [this.#sent, this.#waiting];
    // Changes from now on are changes of this text.
    [this.#sent, this.#waiting] = [null, null];
    const asked = { do: 'together_join', file: this.file.name, name, text, edits, key: sent?.key ?? null } as const;
    const joined = await server.call(asked).catch((error: unknown) => {
      [this.#sent, this.#waiting] = [sent, composed(waited, this.#waiting)];
      throw error;
    });
    this.me = joined.me;
    this.edits = joined.edits;
    this.people = joined.people;
    this.here = new Map(joined.here);
    this.#version = joined.version;
    this.#ready = true;
    if (joined.text === text) this.#confirmed = text;
    else if (joined.text !== null) {
      if (this.#confirmed === null) this.replaced(text);
      const known = this.#confirmed ?? text;
      // A change whose answer was lost is in the text of the others.
      const made = sent && joined.made ? sent.changes : null;
      const rest = made ? waited : composed(sent?.changes ?? null, waited);
      this.#waiting = composed(rest, this.#waiting);
      this.#confirmed = made ? apply(known, asSplices(made)) : known;
      await this.#take(between(this.#confirmed, joined.text));
    }
    void this.#flush();
  }

  /** Somebody has begun to edit, and this page looks. */
  async begun(version: number, text: string): Promise<void> {
    if (this.#confirmed === null) this.replaced(this.file.text);
    this.#version = version;
    this.#confirmed = this.file.text;
    this.#waiting = null;
    await this.#take(between(this.file.text, text));
  }

  /** Somebody else has changed the text. */
  async made({ version, splices }: Made): Promise<void> {
    this.#version = version;
    await this.#take(splices);
  }

  /** Makes a change of the confirmed text in the text here, moved over what is not confirmed. */
  async #take(splices: Splice[]): Promise<void> {
    if (this.#confirmed === null || splices.length === 0) return;
    let theirs = ChangeSet.of(asSpecs(splices), this.#confirmed.length);
    this.#confirmed = apply(this.#confirmed, splices);
    if (this.#sent) [theirs, this.#sent.changes] = crossed(theirs, this.#sent.changes);
    if (this.#waiting) [theirs, this.#waiting] = crossed(theirs, this.#waiting);
    await this.file.others(asSplices(theirs));
  }

  #changed({ splices, origin }: TextChange): void {
    const changes = ChangeSet.of(asSpecs(splices), this.file.text.length - growth(splices));
    this.#moveAll(changes);
    if (origin === 'others') return;
    this.#waiting = composed(this.#waiting, changes);
    void this.#flush();
  }

  /** The places of the others in the text follow its changes. */
  #moveAll(changes: ChangeSet): void {
    const moved = ([id, of]: [number, Here]): [number, Here] => {
      const text = of.text?.map((at) => changes.mapPos(Math.min(at, changes.length)));
      return [id, text ? { ...of, text: text as [number, number] } : of];
    };
    this.here = new Map([...this.here].map(moved));
  }

  /** Sends what waits, one change after the other. */
  async #flush(): Promise<void> {
    if (!this.#ready || !this.edits || this.#sent || !this.#waiting || this.#confirmed === null) return;
    const key = `${here}-${BEGAN}-${++keys}`;
    this.#sent = { changes: this.#waiting, key };
    this.#waiting = null;
    const asked = { do: 'together_change', file: this.file.name, version: this.#version, splices: asSplices(this.#sent.changes), key } as const;
    try {
      const told = await server.call(asked);
      const sent = this.#sent.changes;
      this.#sent = null;
      if ('behind' in told) this.#waiting = composed(sent, this.#waiting);
      else {
        this.#version = told.version;
        this.#confirmed = apply(this.#confirmed, asSplices(sent));
      }
    } catch (error) {
      // It is sent again when the connection is back.
      if (error instanceof Gone) return;
      this.refused(error as Error);
      return;
    }
    void this.#flush();
  }

  /** What is done when the server refuses a change. */
  refused: (why: Error) => void = () => undefined;
  /** What is done with the text here when that of the others comes in its place. */
  replaced: (text: string) => void = () => undefined;

  /** Others have moved. */
  moved(rows: [number, Here][]): void {
    this.here = new Map([...this.here, ...rows]);
  }

  gone(people: readonly Person[]): void {
    this.people = people;
    this.here = new Map([...this.here].filter(([id]) => people.some((p) => p.id === id)));
  }

  end(): void {
    this.#stop();
  }
}
