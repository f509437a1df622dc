// The wiring of the open chart: what the server tells of it, changes of the io file, and values that
// are asked for while the view is open.
import { files } from '../lib/files.svelte';
import { server } from '../lib/server';
import type { Description, Frame } from '../operator/told';
import type { Change, DeviceLive, Live, Reading, Sight } from './told';

/** The pause between two questions to the devices, in ms. */
const PAUSE = 1000;

class Wiring {
  sight: Sight | null = $state.raw(null);
  /** Why nothing is shown, or why the latest change was refused. */
  refused = $state('');
  /** The file was changed by someone else: what is shown is the new state. */
  outside = $state(false);
  busy = $state(false);
  devices: Record<string, DeviceLive> = $state.raw({});
  values: Record<string, Reading> = $state.raw({});
  /** Where the values come from. */
  from: 'devices' | 'controller' | 'other' | 'reached' | 'none' = $state('none');

  #open = 0;
  #told: Description | null = null;
  #off: (() => void) | undefined;

  get #chart(): { path: string; text: string } | null {
    const file = files.current;
    return file ? { path: file.name, text: file.text } : null;
  }

  /** Begins to show the open chart, until the result is called. */
  begin(): () => void {
    const turn = ++this.#open;
    this.#told = null;
    [this.sight, this.refused, this.outside] = [null, '', false];
    [this.devices, this.values, this.from] = [{}, {}, 'none'];
    void this.look().then(() => this.#ask(turn));
    return () => {
      this.#open += 1;
      this.#off?.();
      this.#off = undefined;
    };
  }

  async look(): Promise<void> {
    const chart = this.#chart;
    if (!chart) return;
    try {
      this.sight = await server.wiring<Sight>('look', chart);
      this.refused = '';
    } catch (error) {
      this.refused = (error as Error).message;
    }
  }

  /** Changes the io file; false where it was refused or had changed meanwhile. */
  async change(changes: Change[]): Promise<boolean> {
    const chart = this.#chart;
    if (!chart || !this.sight || changes.length === 0) return changes.length === 0;
    this.busy = true;
    [this.refused, this.outside] = ['', false];
    try {
      const { done, told } = await server.wiringEdit<Sight>({ ...chart, hash: this.sight.hash, changes });
      this.sight = told;
      this.outside = !done;
      return done;
    } catch (error) {
      this.refused = (error as Error).message;
      return false;
    } finally {
      this.busy = false;
    }
  }

  /** Asks for the values as long as the view is open. */
  async #ask(turn: number): Promise<void> {
    while (turn === this.#open) {
      const chart = this.#chart;
      if (chart && !document.hidden && this.#told === null) {
        const live = await server.wiring<Live>('live', chart).catch((): Live => ({}));
        if (turn !== this.#open) return;
        if (live.no === 'online') await this.#watch();
        else if (live.no) this.from = live.no;
        else this.#take(live);
      }
      await new Promise((go) => setTimeout(go, PAUSE));
    }
  }

  #take(live: Live): void {
    if (!live.devices) return;
    this.from = 'devices';
    [this.devices, this.values] = [live.devices, live.values ?? {}];
    // Somebody else has changed the file.
    if (this.sight && live.hash !== undefined && live.hash !== this.sight.hash && !this.busy) void this.look();
  }

  /** Takes the values from the controller of this server, which has the devices. */
  async #watch(): Promise<void> {
    const told = await server.call({ do: 'operator_watch' }).catch(() => null);
    if (!told) return;
    this.#told = told;
    const base = (path: string) => path.split(/[\\/]/).at(-1);
    this.from = base(told.file) === base(files.current?.name ?? '') ? 'controller' : 'other';
    if (this.from === 'other') return;
    const put = (frame: Frame) => {
      if (frame.renew) {
        this.#told = null;
        return;
      }
      const values = { ...this.values };
      for (const [signal, value, quality] of frame.values ?? []) {
        const name = told.signals[signal]?.name;
        if (name) values[name] = quality === 'bad' || quality === 'unread' ? { value, why: quality } : { value };
      }
      if (frame.values) this.values = values;
      if (frame.devices) {
        const state = (up: boolean | null, why: string): DeviceLive => (up ? { is: 'answers' } : { is: 'silent', why });
        this.devices = Object.fromEntries(frame.devices.map((d, n) => [told.devices[n]?.name ?? '', state(d.up, d.why)]));
      }
    };
    put(told.frame);
    this.#off?.();
    this.#off = server.hear((message) => message.operator && put(message.operator as Frame));
  }
}

export const wiring = new Wiring();
