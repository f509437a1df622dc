// The exercises that come with the page, the student's files for them, and the check of a work. A worker of its own checks,
// so that gestures are answered meanwhile; it is ended where it takes too long.
import { openSheet } from '../frame/sheets';
import { drafts } from '../lib/drafts.svelte';
import { files, type OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { Local } from '../lib/page';
import { prefs } from '../lib/prefs.svelte';
import type { ExerciseChecked, ExercisePacked, ExerciseTexts } from '../lib/protocol';
import { shape } from '../lib/shape.svelte';
import { shell } from '../lib/shell.svelte';
import { speech } from '../lib/speech.svelte';
import { summary } from './told';
import { progress } from './progress.svelte';

export type Exercise = ExercisePacked & {
  id: string;
  /** The pictures of its plants, by the names that the template gives them. */
  pictures: Record<string, string>;
};

/** The limits of the search for the answers to questions, in states: first a quick one. */
const ROUNDS: readonly number[] = [2_000, 200_000];
/** The longest time of a check, in ms. */
const LONGEST = 180_000;

/** The findings of a check, and the text that they are about. */
export interface Found {
  id: string;
  file: string;
  hash: string;
  language: string;
  checked: ExerciseChecked;
}

class Exercises {
  all: readonly Exercise[] = $state.raw([]);
  /** The check under way: the exercise, and the states among which it searches. */
  work: { id: string; states: number } | null = $state.raw(null);
  found: Found | null = $state.raw(null);
  failed = $state('');
  #worker = new Local('g7-whole.wasm');
  #turn = 0;
  #list: Promise<void> | null = null;

  /** The exercise of the visible file, by its name. */
  readonly id: string | null = $derived(files.current ? progress.idOf(files.current.name) : null);
  readonly current: Exercise | null = $derived(this.all.find((one) => one.id === this.id) ?? null);
  /** The findings about the visible file. */
  readonly result: Found | null = $derived(this.found && this.found.id === this.id && this.found.file === files.current?.name ? this.found : null);
  /** The text has changed since. */
  readonly old: boolean = $derived(this.result !== null && this.result.hash !== files.current?.look.hash);

  /** Fetches the list; a page without exercises has an empty one. */
  load(): Promise<void> {
    this.#list ??= fetch(new URL('exercises.json', document.baseURI))
      .then(async (answer) => {
        if (answer.ok) this.all = (await answer.json()) as Exercise[];
      })
      .catch(() => {
        this.#list = null;
      });
    return this.#list;
  }

  /** The texts of an exercise in the language of the page. */
  texts(of: Exercise): ExerciseTexts | null {
    return of.texts.find((one) => one.language === prefs.language) ?? of.texts[0] ?? null;
  }

  /** A picture that a file names, if the file belongs to an exercise that brings it. */
  async picture(file: string, name: string): Promise<string | null> {
    const id = progress.idOf(file);
    if (id === null) return null;
    await this.load();
    return this.all.find((one) => one.id === id)?.pictures[name] ?? null;
  }

  /** Opens an exercise with its panel. */
  async show(exercise: Exercise): Promise<void> {
    shell.gallery = false;
    await shell.try(() => this.open(exercise));
    shell.tabs.right = 'exercise';
    if (shape.phone) openSheet('right');
    else prefs.rightOpen = true;
  }

  /** Opens the student's file of an exercise; the first time with the template. */
  async open(exercise: Exercise): Promise<void> {
    const { id, given } = exercise;
    if (!given) return;
    const known = progress.of(id);
    const name = known?.file ?? free(id);
    if (!known) progress.put(id, { file: name, text: given.template });
    if (files.find(name) || shell.inFolder(name)) await files.read(name);
    else await files.open(name, known?.text ?? given.template);
  }

  /** Brings the template back. The text of before goes to the unsaved work, where it can be had back. */
  async again(file: OpenFile, exercise: Exercise): Promise<void> {
    if (!exercise.given || file.text === exercise.given.template) return;
    await drafts.keep(file.name, { text: file.text, base: file.tag ?? '' }, 'closed');
    await file.replace(exercise.given.template);
    this.found = null;
    drafts.soon();
  }

  /** Checks the work in a file, and tells the result. */
  async check(file: OpenFile, exercise: Exercise): Promise<void> {
    const { id, given } = exercise;
    if (!given) return;
    this.cancel();
    const turn = ++this.#turn;
    const mine = () => turn === this.#turn;
    this.failed = '';
    this.work = { id, states: 0 };
    const late = window.setTimeout(() => {
      if (!mine()) return;
      this.cancel();
      this.failed = t('exercise.late');
    }, LONGEST);
    try {
      await file.settled();
      const uses = await file.used();
      const { hash } = file.look;
      const language = prefs.language;
      for (const states of ROUNDS) {
        if (!mine()) return;
        this.work = { id, states };
        const checked = await this.#worker.call({ do: 'exercise_check', name: file.name, text: file.text, uses, exercise: given, states });
        if (!mine()) return;
        this.found = { id, file: file.name, hash, language, checked };
        if (!checked.questions.some((q) => q.verdict === 'open')) break;
      }
      const checked = this.found?.checked;
      if (checked?.mark === 'passed') progress.put(id, { passed: true });
      if (checked) speech.tell('exercise', () => summary(checked).join(' '));
    } catch (error) {
      if (mine()) this.failed = (error as Error).message;
    } finally {
      clearTimeout(late);
      if (mine()) this.work = null;
    }
  }

  /** Ends the check; what was found before stays. */
  cancel(): void {
    this.#turn++;
    if (this.work) this.#worker.stop();
    this.work = null;
  }
}

/** A name that no file has. */
function free(id: string): string {
  const taken = (name: string) => files.find(name) || shell.inFolder(name) || progress.idOf(name);
  let name = `${id}.g7`;
  for (let n = 2; taken(name); n++) name = `${id}-${n}.g7`;
  return name;
}

export const exercises = new Exercises();
