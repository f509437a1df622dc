// The bench of `make online-demo`: a machine, its controller and a broker, each a program of its own, and a
// page that unplugs and plugs them. Ctrl-C ends all of them.
//
//   node demo/bench.mjs PATH/TO/g7 [--no-open]
import { spawn, spawnSync } from 'node:child_process';
import { copyFileSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer as createHttp } from 'node:http';
import { createServer } from 'node:net';
import { tmpdir, userInfo } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const HERE = dirname(fileURLToPath(import.meta.url));
const CHART = join(HERE, '../examples/bead-sorter/chart.g7');
/** Lines that a page which comes later still gets. */
const KEPT = 200;

const [program, ...options] = process.argv.slice(2);
if (!program) {
  console.error('usage: node demo/bench.mjs PATH/TO/g7 [--no-open]');
  process.exit(2);
}
const g7 = resolve(program);
const folder = mkdtempSync(join(tmpdir(), 'g7-demo-'));

async function freePort() {
  const server = createServer();
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  const { port } = server.address();
  await new Promise((done) => server.close(done));
  return port;
}

/** Where Debian puts programs that only root looks for. */
const PATH = `${process.env.PATH}:/usr/sbin:/usr/local/sbin`;
const isThere = (name) => spawnSync('sh', ['-c', `command -v ${name}`], { env: { ...process.env, PATH } }).status === 0;

const ports = { machine: await freePort(), broker: await freePort(), page: await freePort() };
const broker = isThere('mosquitto') && isThere('mosquitto_sub');

copyFileSync(CHART, join(folder, 'sorter.g7'));
let io = readFileSync(join(HERE, 'sorter.io.toml'), 'utf8').replace('1502', ports.machine).replace('1883', ports.broker);
// Without a broker on this machine the bench has none.
if (!broker) io = io.replace(/\[devices\.broker\][^[]*/, '').replace(/\[shown\][^[]*/, '');
writeFileSync(join(folder, 'sorter.io.toml'), io);
// It keeps who listens, so that no event is lost between its own return and that of the listener. As root it
// would become another user, who may not write here.
writeFileSync(
  join(folder, 'mosquitto.conf'),
  [`listener ${ports.broker} 127.0.0.1`, 'allow_anonymous true', `user ${userInfo().username}`, 'persistence true', `persistence_location ${folder}/`, 'autosave_interval 1', 'log_type error', 'log_type warning', 'log_type notice', ''].join('\n'),
);

const pages = new Set();
const lines = [];

/** Tells every page. */
function tell(part, text) {
  const line = { part, text, at: Date.now() };
  lines.push(line);
  if (lines.length > KEPT) lines.shift();
  send({ line });
}

function send(message) {
  for (const page of pages) page.write(`data: ${JSON.stringify(message)}\n\n`);
}

/** A program of the bench. */
class Part {
  constructor(name, command, args, look) {
    Object.assign(this, { name, command, args, look, child: null, state: 'unplugged', address: '' });
  }

  plug() {
    if (this.child) return;
    const child = spawn(this.command, this.args, { cwd: folder, env: { ...process.env, PATH, NO_COLOR: '1' }, stdio: ['pipe', 'pipe', 'pipe'] });
    this.child = child;
    this.become('plugged');
    for (const stream of [child.stdout, child.stderr]) {
      let rest = '';
      stream.on('data', (bytes) => {
        const all = (rest + bytes).split('\n');
        rest = all.pop();
        all.filter(Boolean).forEach((line) => this.look?.(line) || tell(this.name, line));
      });
    }
    child.on('error', (error) => tell(this.name, error.message));
    child.on('exit', () => {
      if (this.child !== child) return;
      this.child = null;
      this.become('unplugged');
    });
  }

  /** As a cable that is pulled, or a program that is killed. */
  unplug() {
    this.child?.kill('SIGKILL');
  }

  freeze() {
    this.child?.kill(this.state === 'frozen' ? 'SIGCONT' : 'SIGSTOP');
    if (this.child) this.become(this.state === 'frozen' ? 'plugged' : 'frozen');
  }

  become(state) {
    this.state = state;
    send({ parts: states() });
  }
}

const parts = {
  machine: new Part('machine', g7, ['plant', 'sorter.g7', '--io', 'sorter.io.toml']),
  controller: new Part('controller', g7, ['serve', 'sorter.g7', '--online', '--no-open', '--port', String(await freePort())], (line) => {
    if (!line.startsWith('http://')) return false;
    parts.controller.address = line.trim();
    send({ parts: states() });
    return true;
  }),
};
if (broker) {
  parts.broker = new Part('broker', 'mosquitto', ['-c', 'mosquitto.conf']);
  parts.listener = new Part('listener', 'mosquitto_sub', ['-p', String(ports.broker), '-t', 'sorter/#', '-v', '-i', 'listener', '-c', '-q', '1']);
}

function states() {
  return Object.values(parts)
    .filter((part) => part.name !== 'listener')
    .map(({ name, state, address }) => ({ name, state, address: name === 'controller' && state !== 'unplugged' ? address : '' }));
}

const acts = {
  plug: (part) => part.plug(),
  unplug: (part) => part.unplug(),
  freeze: (part) => part.freeze(),
  turn: (part) => part.child?.stdin.write(`tilted := ${(turned = !turned) ? 'TRUE' : 'FALSE'}\n`),
};
let turned = false;

const http = createHttp((request, response) => {
  const url = new URL(request.url, `http://127.0.0.1:${ports.page}`);
  // Other pages of the browser do not reach it: neither by another name of this machine nor by a form.
  if (request.headers.host !== `127.0.0.1:${ports.page}`) return void response.writeHead(403).end();
  if (request.method === 'GET' && url.pathname === '/') {
    const policy = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src 'self'";
    return void response.writeHead(200, { 'content-type': 'text/html; charset=utf-8', 'content-security-policy': policy }).end(readFileSync(join(HERE, 'bench.html')));
  }
  if (request.method === 'GET' && url.pathname === '/events') {
    response.writeHead(200, { 'content-type': 'text/event-stream', 'cache-control': 'no-store' });
    pages.add(response);
    response.on('close', () => pages.delete(response));
    return void response.write(`data: ${JSON.stringify({ parts: states(), lines })}\n\n`);
  }
  const [, act, name] = url.pathname.split('/');
  if (request.method === 'POST' && request.headers['x-bench'] && Object.hasOwn(acts, act) && Object.hasOwn(parts, name)) {
    acts[act](parts[name]);
    return void response.writeHead(204).end();
  }
  response.writeHead(404).end();
});

function end() {
  // The controller first, so that it leaves safe outputs.
  for (const part of [parts.controller, parts.listener, parts.machine, parts.broker]) {
    part?.child?.kill('SIGCONT');
    part?.child?.kill(part === parts.controller ? 'SIGINT' : 'SIGTERM');
  }
  setTimeout(() => {
    rmSync(folder, { recursive: true, force: true });
    process.exit(0);
  }, 700);
}
process.on('SIGINT', end);
process.on('SIGTERM', end);

await new Promise((done) => http.listen(ports.page, '127.0.0.1', done));
// The broker is heard as soon as it is there, and again each time.
if (broker) setInterval(() => parts.listener.plug(), 1000);
for (const part of [parts.broker, parts.machine, parts.controller]) part?.plug();
if (!broker) tell('broker', 'mosquitto is not installed: the bench has no broker');
const address = `http://127.0.0.1:${ports.page}/`;
console.log(address);
console.log('Ctrl-C ends the bench');
if (!options.includes('--no-open') && process.env.DISPLAY) spawn('xdg-open', [address], { stdio: 'ignore' }).on('error', () => undefined);
