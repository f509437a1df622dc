// The runs of the page: one for each open file, and one under another profile for a comparison. The
// time of a run advances by the clock of the page, or by that of the server for shared runs.
import { differ, type Difference } from '../run/compare';
import { Run } from '../run/state.svelte';
import { files, type OpenFile } from './files.svelte';
import { t } from './i18n';
import { page, type Move } from './page';
import type { Frame, ProofScan, Started } from './protocol';
import { server } from './server';
import { shell } from './shell.svelte';

export { Run };

export interface Wishes {
  profile?: string;
  scan_ms?: number;
  plant?: string;
  seed?: number;
}

/** A shared run that moves sends frames at least this often, in ms. */
const SILENT = 4000;

class Runs {
  /** The run of each file. */
  #byFile: Map<string, Run> = $state.raw(new Map());
  /** The second run of a comparison. */
  other: Run | null = $state.raw(null);
  difference: Difference | null = $state.raw(null);
  /** The breakpoints of each file. */
  #breaks: Map<string, readonly string[]> = $state.raw(new Map());
  #wishes: Map<string, Wishes> = $state.raw(new Map());
  #heard = false;

  /** The run of the visible file. */
  readonly current: Run | null = $derived(files.current ? (this.#byFile.get(files.current.name) ?? null) : null);

  of(file: string): Run | null {
    return this.#byFile.get(file) ?? null;
  }

  get all(): Run[] {
    return [...this.#byFile.values()];
  }

  wishes(file: string): Wishes {
    return this.#wishes.get(file) ?? {};
  }

  breaks(file: string): readonly string[] {
    return this.#breaks.get(file) ?? [];
  }

  /** Restarts the run of a file, in the page; a comparison restarts with it. */
  async start(file: OpenFile, wishes: Wishes = this.wishes(file.name)): Promise<Run> {
    const other = this.other?.file === file.name ? this.other.started.profile : null;
    const run = await this.#begin(file, wishes);
    if (other && run.started.profile !== other) await this.#beside(run, other);
    else if (other) await this.compare(null);
    return run;
  }

  async #begin(file: OpenFile, wishes: Wishes): Promise<Run> {
    const before = this.of(file.name);
    this.#wishes = new Map(this.#wishes).set(file.name, wishes);
    if (before?.shared) await this.#quit(before);
    const started = await page.call({ do: 'run_start', file: file.name, run: file.name, ...wishes });
    const run = new Run(started, page, false);
    run.speed = before?.speed ?? 1;
    this.#put(file.name, run);
    await this.#tellBreaks(run);
    return run;
  }

  /** Repeats a run that a proof found, in the page and without the plant; it takes the place of the
   * file's run. */
  async repeat(file: OpenFile, moves: ProofScan[]): Promise<Run> {
    if (this.other?.file === file.name) await this.compare(null);
    const before = this.of(file.name);
    if (before?.shared) await this.#quit(before);
    const started = await page.call({ do: 'run_start', file: file.name, run: file.name, plant: 'none', moves });
    const run = new Run(started, page, false);
    this.#put(file.name, run);
    await this.#tellBreaks(run);
    return run;
  }

  /** The run of a file; started if there is none. */
  async get(file: OpenFile): Promise<Run> {
    return this.of(file.name) ?? (await this.start(file));
  }

  async stop(file: string): Promise<void> {
    const run = this.of(file);
    if (!run) return;
    if (this.other?.file === file) await this.compare(null);
    this.#put(file, null);
    if (run.shared) await this.#quit(run);
    else await page.call({ do: 'run_stop', run: run.name });
  }

  /** Sends a message to a run and to the one it is compared with, and takes the frames that come
   * back. */
  async send(run: Run, message: Move): Promise<void> {
    const other = this.other && this.other.file === run.file && !run.shared ? this.other : null;
    const before = run.now;
    const anew = message.do === 'run_restart';
    if (anew) this.difference = null;
    const both = [this.#send(run, message)];
    if (other) both.push(this.#send(other, message));
    await Promise.all(both);
    if (other) this.difference ??= await differ(run, other, anew ? run.now : before);
    if (other && this.difference && run.playing && !this.difference.seen) {
      this.difference = { ...this.difference, seen: true };
      run.playing = false;
    }
  }

  async #send(run: Run, message: Move): Promise<void> {
    run.take(await run.answers.call({ ...message, run: run.name }));
  }

  async play(run: Run, on: boolean): Promise<void> {
    if (!run.live && on) await this.send(run, { do: 'run_live' });
    if (run.shared) await server.call({ do: 'pace', run: run.name, speed: on ? run.speed : 0 });
    run.playing = on && !run.halt;
  }

  async pace(run: Run, speed: number): Promise<void> {
    run.speed = speed;
    if (run.shared && run.playing) await server.call({ do: 'pace', run: run.name, speed });
  }

  async toggleBreak(file: string, id: string): Promise<void> {
    const now = this.breaks(file);
    this.#breaksAre(file, now.includes(id) ? now.filter((b) => b !== id) : [...now, id]);
    const run = this.of(file);
    if (run) await this.#tellBreaks(run);
  }

  async #tellBreaks(run: Run): Promise<void> {
    const ids = [...this.breaks(run.file)];
    await run.answers.call({ do: 'run_breaks', run: run.name, ids });
  }

  /** Starts a second run of the visible file under another profile; both begin from the start. */
  async compare(profile: string | null): Promise<void> {
    const old = this.other;
    this.other = null;
    this.difference = null;
    if (old) await page.call({ do: 'run_stop', run: old.name });
    const file = files.current;
    if (!profile || !file) return;
    await this.#beside(await this.#begin(file, this.wishes(file.name)), profile);
  }

  async #beside(run: Run, profile: string): Promise<void> {
    this.difference = null;
    const started = await page.call({ do: 'run_start', ...this.wishes(run.file), file: run.file, run: `${run.file}|b`, profile });
    const other = new Run(started, page, false);
    this.other = other;
    this.difference = await differ(run, other);
  }

  /** Continues a run with a changed text; asks first if something would be lost, unless `quiet`
   * forbids it. */
  async swap(file: OpenFile, force = false, quiet = false): Promise<void> {
    const run = this.of(file.name);
    if (!run || run.hash === file.look.hash) return;
    try {
      const wish = { do: 'run_swap', run: run.name, file: file.name, force } as const;
      const answer = await (run.shared ? server.call({ ...wish, text: file.text, uses: await file.used() }) : page.call(wish));
      run.refused = null;
      if ('lost' in answer) {
        run.losing = quiet ? null : answer.lost;
        return;
      }
      run.begin(answer);
      run.foreign = false;
      run.losing = null;
      if (this.other?.file === file.name) await this.compare(null);
    } catch (error) {
      run.losing = null;
      run.refused = (error as Error).message;
    }
  }

  /** Hands a run to the server, or joins the server's run of this file. */
  async share(file: OpenFile): Promise<void> {
    this.#hear();
    const { runs } = await server.call({ do: 'runs' });
    const known = runs.find((r) => r.file === file.name);
    const started = await (known
      ? server.call({ do: 'watch', run: known.run })
      : server.call({ do: 'run_start', ...this.wishes(file.name), run: file.name, file: file.name, text: file.text, uses: await file.used() }));
    const before = this.of(file.name);
    // The run must be known before any waiting, because its frames come from now on.
    const run = new Run(started, server, true);
    run.foreign = run.hash !== file.look.hash;
    this.#paced(run, started.speed);
    this.#put(file.name, run);
    if (known) this.#breaksAre(file.name, started.breaks);
    else await this.#tellBreaks(run);
    if (before) await page.call({ do: 'run_stop', run: before.name }).catch(() => undefined);
    if (this.other) await this.compare(null);
  }

  /** True if the server has a run of this file. */
  async isShared(file: string): Promise<boolean> {
    if (!server.info) return false;
    const { runs } = await server.call({ do: 'runs' });
    return runs.some((r) => r.file === file);
  }

  #paced(run: Run, speed: number): void {
    run.playing = speed > 0;
    if (speed > 0) run.speed = speed;
  }

  async #quit(run: Run): Promise<void> {
    await server.call({ do: 'unwatch', run: run.name }).catch(() => undefined);
  }

  /** Handles the messages that the server sends on its own about shared runs. */
  #hear(): void {
    if (this.#heard) return;
    this.#heard = true;
    setInterval(() => this.all.forEach((run) => void this.#again(run)), SILENT);
    server.hear((message) => {
      const named = (name: string) => this.all.find((r) => r.shared && r.name === name);
      if (message.frame) named((message.frame as Frame).run)?.take(message.frame as Frame);
      if (message.started) this.#begun(message.started as Started);
      if (message.breaks) {
        const { run, ids } = message.breaks as { run: string; ids: string[] };
        const of = named(run);
        if (of) this.#breaksAre(of.file, ids);
      }
      if (message.pace) {
        const { run, speed } = message.pace as { run: string; speed: number };
        const paced = named(run);
        if (paced) this.#paced(paced, speed);
      }
      if (message.ended) {
        const run = named((message.ended as { run: string }).run);
        if (run) this.#put(run.file, null);
      }
    });
  }

  /** Another client restarted a shared run, or continued it with a changed chart. */
  #begun(started: Started): void {
    const run = this.all.find((r) => r.shared && r.name === started.run);
    if (!run) return;
    run.begin(started);
    run.foreign = run.hash !== files.find(run.file)?.look.hash;
    this.#breaksAre(run.file, started.breaks);
  }

  #breaksAre(file: string, ids: readonly string[]): void {
    this.#breaks = new Map(this.#breaks).set(file, ids);
  }

  /** The connection is lost: of shared runs the page has the last frame alone. */
  lost(): void {
    for (const run of this.all.filter((r) => r.shared)) {
      run.away = true;
      run.playing = false;
    }
  }

  /** The server is there again: its runs are watched anew, and those that ended with it are over. */
  async back(): Promise<void> {
    const away = this.all.filter((r) => r.away);
    if (away.length === 0) return;
    const there = (await server.call({ do: 'runs' })).runs.map((r) => r.run);
    for (const run of away) {
      const started = there.includes(run.name) ? await server.call({ do: 'watch', run: run.name }).catch(() => null) : null;
      if (this.of(run.file) !== run) continue;
      if (started) {
        run.away = false;
        this.#begun(started);
        this.#paced(run, started.speed);
      } else {
        this.#put(run.file, null);
        shell.say(t('gone.run', { name: run.file }), 'error');
      }
    }
  }

  /** A shared run that moves was silent: its frames were lost. */
  async #again(run: Run): Promise<void> {
    if (!run.shared || run.away || !run.playing || performance.now() - run.heard < SILENT) return;
    try {
      run.begin(await server.call({ do: 'watch', run: run.name }));
    } catch (error) {
      run.playing = false;
      shell.say((error as Error).message, 'error');
    }
  }

  #put(file: string, run: Run | null): void {
    const next = new Map(this.#byFile);
    if (run) next.set(file, run);
    else next.delete(file);
    this.#byFile = next;
  }

  /** Does something with the run of the visible file; starts it if there is none. */
  async act(work: (run: Run) => Promise<void>): Promise<void> {
    const file = files.current;
    if (!file) return;
    await shell.try(async () => work(await this.get(file)));
  }
}

export const runs = new Runs();
