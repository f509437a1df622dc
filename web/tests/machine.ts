// A machine for the stories of the operator: a mixer whose plant stands behind Modbus TCP (`g7 plant`),
// and its controller (`g7 serve --online`).
import { execFileSync, spawn, type ChildProcess } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { ended, program, STATE } from './lib';

const CHART = `profile iec60848
input start : BOOL at %I0.0 "start button"
input high : BOOL at %I0.1 "tank is full"
input low : BOOL at %I0.2 "tank is not empty"
input temperature : REAL "degrees in the tank"
input io_ok : BOOL "the module answers"
output fill : BOOL at %Q0.0 "inlet valve"
output stir : BOOL at %Q0.1 "stirrer"
output heat : BOOL at %Q0.2 "heating"
output drain : BOOL at %Q0.3 "outlet valve"
output lamp : BOOL at %Q0.4 "ready" safe TRUE
output speed : INT "stirrer, turns a minute" safe 0
var batches : INT := 0
var divisor : INT := 1

chart Mixer {
  initial step 0 "ready" { N lamp }
  step 1 "filling" { N fill }
  step 2 "stirring" { N stir  P1 speed := 120 / divisor }
  step 3 "stirred" { P1 speed := 0 }
  step 4 "heating" { N heat }
  step 5 "warm"
  step 6 "draining" { N drain  P1 batches := batches + 1 }
  0 -> 1 when start and io_ok
  1 -> (2, 4) when high
  2 -> 3 when 30s/X2
  4 -> 5 when temperature >= 40.0
  (3, 5) -> 6 when TRUE
  6 -> 0 when not low
}

plant Tank {
  state level : REAL := 0.0 in 0.0 .. 100.0
  state warm : REAL := 20.0 in 15.0 .. 90.0
  state pressed : BOOL := FALSE
  rate level := 50.0 when fill
  rate level := -40.0 when drain
  rate warm := 5.0 when heat
  rate warm := -2.0 when drain
  drive start := pressed
  drive high := level > 95.0
  drive low := level > 2.0
  drive temperature := warm
  drive io_ok := TRUE
}
`;

const io = (port: number, server: string) => `[controller]
${server && "log = 'mixer.log'"}
period = "20ms"
watchdog = "10s"
start = "stop"
[devices.rack1]
kind = "modbus-tcp"
host = "127.0.0.1"
port = ${port}
timeout = "1s"
retry = "300ms"
[inputs]
start = { at = "rack1.discrete(0)", bad = false }
high = "rack1.discrete(1)"
low = "rack1.discrete(2)"
temperature = { at = "rack1.input(0)", as = "f32" }
io_ok = "rack1.good()"
[outputs]
fill = "rack1.coil(0)"
stir = "rack1.coil(1)"
heat = "rack1.coil(2)"
drain = "rack1.coil(3)"
lamp = "rack1.coil(4)"
speed = "rack1.holding(0)"
[history]
file = "mixer.history"
${server}`;

/** A filling station that is operated on the page alone, with a picture of its plant. */
const DESK = `profile iec60848
input start : BOOL "Start"
input hold : BOOL "Hold"
input mode : INT "Mode"
input amount : REAL "Amount, litres"
input auto : BOOL "Automatic"
input level : REAL "level in the tank"
output valve : BOOL "Inlet valve"
output ready : BOOL "Ready"
output alarm : BOOL "Tank is full"
output count : INT "Fillings" safe 0
chart Fill {
  initial step 0 { N ready }
  step 1 "filling" { N valve }
  step 2 "full" { N alarm  P1 count := count + 1 }
  0 -> 1 when start and mode = 1 and not hold
  1 -> 2 when level >= amount
  2 -> 0 when auto
}
plant Tank {
  state height : REAL := 30.0 in 0.0 .. 100.0
  state foam : REAL := 5.0
  rate height := 1.0 when valve
  drive level := height
  view 'tank.svg' { water.level := height / 100.0  pipe.open := valve  lamp.on := ready  bubbles.dy := foam }
}
`;

const DESK_IO = `[controller]
watchdog = "10s"
[devices.desk]
kind = "panel"
[inputs]
mode = "desk.choice(A1, F1, F4, D1)"
start = "desk.button()"
hold = "desk.switch()"
auto = "desk.switch()"
amount = { at = "desk.number()", min = 0, max = 100, initial = 80 }
level = { at = "desk.number()", initial = 30 }
[outputs]
valve = "desk.lamp(blue)"
ready = "desk.lamp()"
alarm = "desk.lamp(red)"
count = "desk.value()"
`;

const TANK = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 320 200"><style>.pipe { fill: #9aa7b8 } .pipe.open { fill: #2b7de0 } .lamp { fill: #8894a5 } .lamp.on { fill: #1c9a4b }</style>
<path class="pipe" data-g7="pipe" d="M20 30h120v18H20z"/><rect x="110" y="56" width="120" height="124" rx="8" fill="none" stroke="#77859a" stroke-width="4"/>
<rect data-g7="water" x="114" y="60" width="112" height="116" fill="#5aa4ea"/><g data-g7="bubbles" fill="#8a6fd1"><circle cx="150" cy="90" r="6"/><circle cx="170" cy="80" r="4"/><circle cx="190" cy="94" r="5"/></g>
<circle class="lamp" data-g7="lamp" cx="280" cy="40" r="14"/></svg>`;

async function freePort(): Promise<number> {
  const server = createServer();
  const port = await new Promise<number>((found) => server.listen(0, '127.0.0.1', () => found((server.address() as { port: number }).port)));
  await new Promise((done) => server.close(done));
  return port;
}

/** A program that is waited for until it says something. */
async function begun(args: string[], cwd: string, from: 'stdout' | 'stderr', what: RegExp): Promise<{ child: ChildProcess; found: string }> {
  const child = spawn(program(), args, { cwd, stdio: ['pipe', 'pipe', 'pipe'], env: { ...process.env, XDG_STATE_HOME: STATE } });
  let said = '';
  const found = await new Promise<string>((resolve, reject) => {
    for (const stream of ['stdout', 'stderr'] as const) {
      child[stream].on('data', (chunk: Buffer) => {
        if (stream !== from) return;
        said += chunk.toString();
        const match = what.exec(said)?.[0];
        if (match) resolve(match);
      });
    }
    child.once('exit', (code) => reject(new Error(`g7 ${args.join(' ')} ended with ${code}: ${said}`)));
  });
  return { child, found };
}

/** The machine, with or without its plant. */
export class Machine {
  url = '';
  #folder = mkdtempSync(join(tmpdir(), 'g7-machine-'));
  #port = 0;
  #plant: ChildProcess | null = null;
  #station: ChildProcess | null = null;

  async #lay(server: string): Promise<void> {
    this.#port = await freePort();
    writeFileSync(join(this.#folder, 'mixer.g7'), CHART);
    writeFileSync(join(this.#folder, 'mixer.io.toml'), io(this.#port, server));
    await this.plug();
  }

  /** With TLS, a log and no user yet; the code of the console. */
  static async guarded(): Promise<{ machine: Machine; code: string }> {
    const machine = new Machine();
    await machine.#lay("[server]\nusers = 'g7.users'\ncert = 'g7.cert.pem'\nkey = 'g7.key.pem'\n");
    execFileSync(program(), ['cert'], { cwd: machine.#folder, stdio: 'ignore' });
    const port = await freePort();
    const { child, found } = await begun(['serve', 'mixer.g7', '--online', '--no-open', '--port', String(port)], machine.#folder, 'stderr', /code: \S+/);
    machine.#station = child;
    machine.url = `https://127.0.0.1:${port}/operator`;
    return { machine, code: found.replace('code: ', '') };
  }

  static async start(): Promise<Machine> {
    const machine = new Machine();
    await machine.#lay('');
    const { child, found } = await begun(['serve', 'mixer.g7', '--online', '--no-open', '--port', '0'], machine.#folder, 'stdout', /http:\/\/\S+/);
    machine.#station = child;
    machine.url = found;
    return machine;
  }

  /** The editor with the mixer's wiring; its devices are there, and no controller. */
  static async editor(): Promise<Machine> {
    const machine = new Machine();
    machine.#port = await freePort();
    writeFileSync(join(machine.#folder, 'mixer.g7'), CHART);
    machine.io = io(machine.#port, '');
    await machine.plug();
    const { child, found } = await begun(['serve', 'mixer.g7', '--no-open', '--port', '0'], machine.#folder, 'stdout', /http:\/\/\S+/);
    [machine.#station, machine.url] = [child, found];
    return machine;
  }

  /** A machine that has a panel on the page and no device. */
  static async desk(): Promise<Machine> {
    const machine = new Machine();
    for (const [name, text] of [['filler.g7', DESK], ['filler.io.toml', DESK_IO], ['tank.svg', TANK]] as const) writeFileSync(join(machine.#folder, name), text);
    const { child, found } = await begun(['serve', 'filler.g7', '--online', '--no-open', '--port', '0'], machine.#folder, 'stdout', /http:\/\/\S+/);
    [machine.#station, machine.url] = [child, found];
    return machine;
  }

  /** The io file, as it is on the disk. */
  get io(): string {
    return readFileSync(join(this.#folder, 'mixer.io.toml'), 'utf8');
  }

  set io(text: string) {
    writeFileSync(join(this.#folder, 'mixer.io.toml'), text);
  }

  /** The device is there. */
  async plug(): Promise<void> {
    this.#plant = (await begun(['plant', 'mixer.g7'], this.#folder, 'stderr', /running/)).child;
  }

  /** The device is gone. */
  async unplug(): Promise<void> {
    if (this.#plant) await ended(this.#plant, 'SIGKILL');
  }

  /** The file of the chart is written anew, as an editor does it. */
  edit(change: (chart: string) => string): void {
    writeFileSync(join(this.#folder, 'mixer.g7'), change(CHART));
  }

  /** A hand at the machine. */
  press(on: boolean): void {
    this.#plant?.stdin?.write(`pressed := ${on ? 'TRUE' : 'FALSE'}\n`);
  }

  /** The scan and the server stop as if the machine had frozen, or go on. */
  freeze(on: boolean): void {
    this.#station?.kill(on ? 'SIGSTOP' : 'SIGCONT');
  }

  /** The controller ends as by Ctrl-C; its exit code. */
  async end(): Promise<number | null> {
    return this.#station ? ended(this.#station, 'SIGINT') : null;
  }

  async done(): Promise<void> {
    await this.end();
    await this.unplug();
    rmSync(this.#folder, { recursive: true, force: true });
  }
}

const BENCH = new URL('../../demo/bench.mjs', import.meta.url).pathname;

/** The bench of `make online-demo`. */
export async function bench(): Promise<{ url: string; end(): Promise<void> }> {
  const child = spawn('node', [BENCH, program(), '--no-open'], { stdio: ['ignore', 'pipe', 'inherit'], env: { ...process.env, XDG_STATE_HOME: STATE } });
  const url = await new Promise<string>((found) => child.stdout.once('data', (bytes: Buffer) => found(String(bytes).split('\n')[0] ?? '')));
  return {
    url,
    async end() {
      await ended(child, 'SIGINT');
    },
  };
}
