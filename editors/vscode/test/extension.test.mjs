// The extension as it is shipped, with a stub of VS Code: its commands, its panels and their server. With G7
// in the environment, the real program serves the page.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { chmodSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import Module, { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { crc32, inflateRawSync } from 'node:zlib';

const require = createRequire(import.meta.url);
const here = new URL('..', import.meta.url).pathname;
const { vscode, did, commands, settings } = require('./stub/vscode.cjs');
const clients = [];

class LanguageClient {
  constructor(id, name, server, options) {
    Object.assign(this, { id, name, server, options, state: 'made' });
    clients.push(this);
  }
  async start() {
    this.state = 'started';
  }
  async stop() {
    this.state = 'stopped';
  }
}

const scratch = mkdtempSync(join(tmpdir(), 'g7-vscode-'));
after(() => rmSync(scratch, { recursive: true, force: true }));

/** The sources, bundled with the client of the protocol left out, which the stub takes the place of. */
function load() {
  const out = join(scratch, 'extension.cjs');
  const options = ['--bundle', '--platform=node', '--format=cjs', '--external:vscode', '--external:vscode-languageclient/node', `--outfile=${out}`];
  execFileSync(join(here, 'node_modules/.bin/esbuild'), [join(here, 'src/extension.ts'), ...options, '--log-level=error']);
  const resolve = Module._load;
  Module._load = (name, ...rest) => {
    if (name === 'vscode') return vscode;
    if (name === 'vscode-languageclient/node') return { LanguageClient };
    return resolve(name, ...rest);
  };
  return require(out);
}

/** A program in place of g7 that prints an address like `g7 serve`, and notes how it was called and ended. */
const log = join(scratch, 'log');
const program = join(scratch, 'fake-g7');
writeFileSync(
  program,
  `#!/usr/bin/env node
const { appendFileSync } = require('node:fs');
if (process.argv[2] === '--version') process.exit(0);
appendFileSync(${JSON.stringify(log)}, JSON.stringify(process.argv.slice(2)) + '\\n');
process.on('SIGINT', () => { appendFileSync(${JSON.stringify(log)}, 'ended\\n'); process.exit(0); });
console.log('http://127.0.0.1:47123/?token=abc');
setInterval(() => {}, 1000);
`,
);
chmodSync(program, 0o755);
settings.path = program;
const logged = () => (existsSync(log) ? readFileSync(log, 'utf8').trim().split('\n') : []);

const extension = load();
const context = { subscriptions: [] };
const chart = join(scratch, 'a tank.g7');
writeFileSync(chart, 'chart A {\n  initial step 0\n}\n');

async function until(holds, what) {
  for (let i = 0; i < 300; i++) {
    if (holds()) return;
    await new Promise((done) => setTimeout(done, 20));
  }
  assert.fail(what);
}

test('the language server is started for files and for new texts', async () => {
  await extension.activate(context);
  assert.equal(clients.length, 1);
  assert.deepEqual(clients[0].server, { command: program, args: ['lsp'] });
  assert.deepEqual(clients[0].options.documentSelector.map((s) => s.scheme), ['file', 'untitled']);
  assert.equal(clients[0].state, 'started');
});

test('each command of the manifest is there, and no other', () => {
  const manifest = JSON.parse(readFileSync(join(here, 'package.json'), 'utf8'));
  const told = manifest.contributes.commands.map((c) => c.command).sort();
  assert.deepEqual([...commands.keys()].sort(), told);
});

test('a lens above a test runs that test, by its title', async () => {
  did.length = 0;
  const uri = vscode.Uri.file(chart).toString();
  await commands.get('g7.test')(uri, 'stops after "five" bottles');
  const [[what, task]] = did;
  assert.equal(what, 'task');
  assert.equal(task.execution.process, program);
  assert.deepEqual(task.execution.args, ['test', chart, '--filter', 'stops after "five" bottles']);
  assert.equal(task.execution.options.cwd, scratch);
});

test('without an argument the file of the editor in front is run, saved before', async () => {
  did.length = 0;
  let saved = 0;
  const uri = vscode.Uri.file(chart);
  vscode.window.activeTextEditor = { document: { uri } };
  vscode.workspace.textDocuments = [{ uri, isDirty: true, save: async () => ++saved > 0 }];
  await commands.get('g7.run')();
  await commands.get('g7.prove')();
  vscode.workspace.textDocuments = [];
  assert.equal(saved, 2);
  assert.deepEqual(did.map(([, task]) => task.execution.args), [['run', chart], ['prove', chart, '--all']]);
});

test('a text that is no file is refused in words', async () => {
  did.length = 0;
  await commands.get('g7.run')('untitled:Untitled-1');
  assert.equal(did[0][0], 'error');
  assert.match(did[0][1], /save/);
});

test('the values of a run are shown from the address that is typed, and nothing happens without one', async () => {
  did.length = 0;
  await commands.get('g7.values')();
  assert.deepEqual(did, []);
  vscode.window.typed = ' http://127.0.0.1:4700/?token=abc ';
  await commands.get('g7.values')();
  assert.deepEqual(did, [['command', 'g7.follow', 'http://127.0.0.1:4700/?token=abc']]);
});

test('a program that is missing is told, with the way to the setting', async () => {
  did.length = 0;
  settings.path = join(scratch, 'missing');
  await commands.get('g7.restart')();
  assert.equal(clients[0].state, 'stopped');
  assert.match(did[0][1], /missing lsp` cannot be started/);
  assert.equal(clients.length, 1);
  settings.path = program;
  await commands.get('g7.restart')();
  assert.equal(clients.at(-1).state, 'started');
});

test('the drawing: one server for a folder, one panel for a file, and an end with the last panel', async () => {
  did.length = 0;
  const other = join(scratch, 'b.g7');
  writeFileSync(other, '');
  await commands.get('g7.draw')(vscode.Uri.file(chart));
  await commands.get('g7.draw')(vscode.Uri.file(other));
  await commands.get('g7.draw')(vscode.Uri.file(chart));
  const panels = did.filter(([what]) => what === 'panel').map(([, panel]) => panel);
  assert.equal(panels.length, 2);
  assert.deepEqual(did.at(-1), ['reveal', 'a tank.g7']);
  assert.deepEqual(logged().map((l) => JSON.parse(l)), [['serve', scratch, '--no-open', '--framed']]);
  const html = panels[0].webview.html;
  assert.match(html, /<iframe src="http:\/\/127\.0\.0\.1:47123\/\?token=abc&#38;file=a\+tank\.g7"/);
  assert.match(html, /frame-src http:\/\/127\.0\.0\.1:47123;/);
  const followed = () => did.filter(([what]) => what === 'command').map(([, ...told]) => told);
  assert.deepEqual(followed(), [['g7.follow', 'http://127.0.0.1:47123/?token=abc']]);
  panels[0].dispose();
  panels[1].dispose();
  assert.deepEqual(followed().at(-1), ['g7.follow', '']);
  await until(() => logged().at(-1) === 'ended', 'the server goes on without a panel');
  settings.path = program;
});

test('in a browser on this machine the page is shown under its own address, and VS Code is named to its server', async () => {
  did.length = 0;
  vscode.env.uiKind = vscode.UIKind.Web;
  const outside = vscode.env.asExternalUri;
  vscode.env.asExternalUri = async (uri) => vscode.Uri.parse(`http://127.0.0.1:8080/proxy/${new URL(uri.toString()).port}/`);
  await commands.get('g7.draw')(vscode.Uri.file(chart));
  const panel = did.find(([what]) => what === 'panel')[1];
  assert.match(panel.webview.html, /iframe src="http:\/\/127\.0\.0\.1:47123\//);
  assert.equal(JSON.parse(logged().at(-1)).at(-1), '--framed=http://127.0.0.1:8080');
  panel.dispose();
  // A proxy gives the page a name that its server does not answer to.
  vscode.env.uiKind = vscode.UIKind.Desktop;
  await commands.get('g7.draw')(vscode.Uri.file(chart));
  const other = did.filter(([what]) => what === 'panel').at(-1)[1];
  assert.match(other.webview.html, /Forward port 47123/);
  other.dispose();
  vscode.env.asExternalUri = outside;
});

test('a server that does not start is told in the panel', async () => {
  did.length = 0;
  settings.path = join(scratch, 'nothing');
  await commands.get('g7.draw')(vscode.Uri.file(chart));
  const panel = did.find(([what]) => what === 'panel')[1];
  assert.match(panel.webview.html, /cannot be started/);
  assert.doesNotMatch(panel.webview.html, /iframe src/);
  panel.dispose();
  settings.path = program;
});

test('the real program serves a page that a panel may show', { skip: process.env.G7 === undefined }, async () => {
  did.length = 0;
  settings.path = process.env.G7;
  await commands.get('g7.draw')(vscode.Uri.file(chart));
  const panel = did.find(([what]) => what === 'panel')[1];
  const address = /iframe src="([^"]+)"/.exec(panel.webview.html)?.[1].replaceAll('&#38;', '&');
  assert.ok(address, panel.webview.html);
  const answer = await fetch(address);
  assert.equal(answer.status, 200);
  assert.equal(answer.headers.get('x-frame-options'), null);
  assert.match(answer.headers.get('content-security-policy'), /frame-ancestors [^;]*vscode-webview:/);
  panel.dispose();
  settings.path = program;
});

/** The files of a zip, by its directory; each is held to its sum. */
function unzipped(zip) {
  const files = new Map();
  const end = zip.lastIndexOf('PK\x05\x06', undefined, 'latin1');
  let at = zip.readUInt32LE(end + 16);
  for (let left = zip.readUInt16LE(end + 10); left > 0; left--) {
    assert.equal(zip.toString('latin1', at, at + 4), 'PK\x01\x02');
    const [packed, length] = [zip.readUInt32LE(at + 20), zip.readUInt16LE(at + 28)];
    const name = zip.toString('utf8', at + 46, at + 46 + length);
    const local = zip.readUInt32LE(at + 42);
    assert.equal(zip.toString('latin1', local, local + 4), 'PK\x03\x04');
    const from = local + 30 + zip.readUInt16LE(local + 26) + zip.readUInt16LE(local + 28);
    const data = inflateRawSync(zip.subarray(from, from + packed));
    assert.equal(crc32(data), zip.readUInt32LE(at + 16), name);
    assert.equal(zip.readUInt32LE(local + 14), zip.readUInt32LE(at + 16), name);
    files.set(name, data);
    at += 46 + length + zip.readUInt16LE(at + 30) + zip.readUInt16LE(at + 32);
  }
  return files;
}

test('the packed extension has every file that its manifest names', () => {
  const file = join(scratch, 'g7.vsix');
  execFileSync('node', [join(here, 'pack.mjs'), file]);
  const files = unzipped(readFileSync(file));
  const names = [...files.keys()];
  const read = (name) => files.get(name).toString();
  const manifest = JSON.parse(read('extension/package.json'));
  const inside = (path) => `extension/${path.replace(/^\.\//, '')}`;
  const wanted = [manifest.main, ...manifest.contributes.grammars.map((g) => g.path), ...manifest.contributes.languages.map((l) => l.configuration)].map(inside);
  for (const name of ['extension.vsixmanifest', '[Content_Types].xml', 'extension/LICENSE.txt', 'extension/README.md', ...wanted]) {
    assert.ok(names.includes(name), `${name} is missing`);
  }
  const types = read('[Content_Types].xml');
  for (const name of names.filter((n) => n !== '[Content_Types].xml')) {
    assert.ok(types.includes(`Extension=".${name.split('.').at(-1)}"`), `${name} has no type`);
  }
  for (const name of names.filter((n) => n.endsWith('.json'))) JSON.parse(read(name));
  // The licence of each package that is bundled.
  for (const name of ['vscode-languageclient', 'vscode-jsonrpc']) assert.ok(read('extension/NOTICES.txt').includes(`${name} `), name);
  assert.match(read('extension.vsixmanifest'), new RegExp(`Id="${manifest.name}" Version="${manifest.version}"`));
});

test('deactivating ends the language server', async () => {
  await extension.deactivate();
  assert.equal(clients.at(-1).state, 'stopped');
});
