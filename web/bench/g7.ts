// The editor itself, with an interface for the benchmark.
import '../src/lib/theme.css';
import { mount } from 'svelte';
import App from '../src/App.svelte';
import { editor } from '../src/canvas/editor.svelte';
import { files } from '../src/lib/files.svelte';
import { live } from '../src/lib/live.svelte';
import { runs } from '../src/lib/runs.svelte';
import { page } from '../src/lib/page';
import { prefs } from '../src/lib/prefs.svelte';
import { shell } from '../src/lib/shell.svelte';
import { active, chartText } from './chart';
import { changed } from './watch.svelte';

prefs.leftOpen = prefs.rightOpen = prefs.bottomOpen = false;
prefs.view = location.search.includes('text') ? 'text' : 'chart';
const target = document.getElementById('app');
if (target) mount(App, { target });

let steps = 1000;
/** The time that `watch` waits for. */
let seen: Promise<number> | undefined;

const frame = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
const key = () => new Promise<number>((pressed) => addEventListener('keydown', () => pressed(performance.now()), { capture: true, once: true }));

/** From the next key until something is another than before, and painted; in ms. */
async function until(value: () => unknown): Promise<number> {
  const another = changed(value);
  const start = await key();
  await another;
  await frame();
  return performance.now() - start;
}

Object.assign(window, {
  bench: {
    async ready() {
      // The module is already loaded and warm, as when a user opens a second file.
      await page.call({ do: 'open', file: 'warm.g7', text: chartText(40) });
      await page.call({ do: 'drawing', file: 'warm.g7', chart: 'Big' });
    },
    async show(n: number) {
      steps = n;
      await files.open(`big-${n}.g7`, chartText(n));
      while (editor.scene?.drawing.items.length === undefined || !document.querySelector('.still [data-id], .still .far')) await frame();
      await frame();
    },
    tick(n: number) {
      const on = active(steps, n);
      live.running = true;
      live.on = new Set(on.map((i) => `Big/s/${i}`));
      live.enabled = new Map(on.map((i) => [`Big/t/${i}`, n % 2 === 0 ? 1 : 2]));
    },
    /** A real run of the same chart, computed by the module in its worker. */
    async run() {
      const file = await files.open(`run-${steps}.g7`, chartText(steps, true));
      await frame();
      await runs.play(await runs.start(file), true);
      await frame();
      this.actual();
    },
    whole: () => editor.camera?.fit(),
    actual() {
      editor.camera?.zoomBy(1 / editor.view.k);
      const [x, y, w, h] = editor.scene?.drawing.area ?? [0, 0, 0, 0];
      editor.camera?.moveTo(x + w / 2, y + Math.min(h / 2, 400));
    },
    /** Selects a step in the middle, behind which a key inserts the next one. */
    select() {
      live.running = false;
      shell.select([`Big/s/${steps / 2 + 7}`]);
      editor.camera?.focus();
    },
    /** Opens a text of this many lines, with the cursor behind a receptivity in its middle. */
    async text(lines: number) {
      const text = chartText((lines - 4) / 2);
      const file = await files.open('long.g7', text);
      await frame();
      const at = text.indexOf('+ ↑c', text.length * 0.75) + 4;
      shell.showText(file, at, at);
      await frame();
    },
    /** Waits from the next key on for another drawing, or for other problems of the text. */
    watch(what: 'scene' | 'problems') {
      seen = until(what === 'scene' ? () => editor.scene : () => files.current?.look.problems.length);
    },
    seen: () => seen,
    marked: () => document.querySelectorAll('.cm-lintRange').length,
  },
});
