// A client of the Language Server Protocol by the libraries of VS Code. Standard input: { g7, uri, text, steps }, each step
// one of the things that people do in an editor; standard output: what the server told for each step, as JSON.
const { readFileSync } = require('node:fs');
const { spawn } = require('node:child_process');
const { StreamMessageReader, StreamMessageWriter, createProtocolConnection, ...lsp } = require('vscode-languageserver-protocol/node');

const { g7, args, uri, text, steps } = JSON.parse(readFileSync(0, 'utf8'));
const server = spawn(g7, ['lsp', ...(args ?? [])], { stdio: ['pipe', 'pipe', 'inherit'] });
const connection = createProtocolConnection(new StreamMessageReader(server.stdout), new StreamMessageWriter(server.stdin));
const textDocument = { uri };
let version = 1;

// The problems of a version of the text, as soon as they are told.
const told = new Map();
const waiting = new Map();
connection.onNotification(lsp.PublishDiagnosticsNotification.type, (p) => {
  if (p.uri !== uri || p.version === undefined) return;
  told.set(p.version, p.diagnostics);
  waiting.get(p.version)?.(p.diagnostics);
});
const problems = () => told.has(version) ? told.get(version) : new Promise((done) => waiting.set(version, done));

const deeds = {
  // Typing, one character after the other; the problems behind each.
  async type({ at, characters }) {
    const seen = [];
    let { line, character } = at;
    for (const c of characters) {
      version += 1;
      const range = { start: { line, character }, end: { line, character } };
      const contentChanges = [{ range, text: c }];
      await connection.sendNotification(lsp.DidChangeTextDocumentNotification.type, { textDocument: { uri, version }, contentChanges });
      character += c.length;
      seen.push((await problems()).map((d) => `${d.code} ${d.range.start.line}:${d.range.start.character}`));
    }
    return seen;
  },
  async erase({ range }) {
    version += 1;
    const contentChanges = [{ range, text: '' }];
    await connection.sendNotification(lsp.DidChangeTextDocumentNotification.type, { textDocument: { uri, version }, contentChanges });
    return (await problems()).map((d) => d.code);
  },
  async complete({ at }) {
    const found = await connection.sendRequest(lsp.CompletionRequest.type, { textDocument, position: at });
    return (Array.isArray(found) ? found : found.items).map((i) => i.label);
  },
  async hover({ at }) {
    const found = await connection.sendRequest(lsp.HoverRequest.type, { textDocument, position: at });
    return found?.contents.value ?? null;
  },
  async rename({ at, to }) {
    const found = await connection.sendRequest(lsp.RenameRequest.type, { textDocument, position: at, newName: to });
    return found.changes;
  },
  async format() {
    return connection.sendRequest(lsp.DocumentFormattingRequest.type, { textDocument, options: { tabSize: 2, insertSpaces: true } });
  },
};

async function main() {
  connection.listen();
  const capabilities = { workspace: { inlayHint: { refreshSupport: true } } };
  const hello = await connection.sendRequest(lsp.InitializeRequest.type, { processId: process.pid, rootUri: null, capabilities });
  await connection.sendNotification(lsp.InitializedNotification.type, {});
  await connection.sendNotification(lsp.DidOpenTextDocumentNotification.type, { textDocument: { uri, languageId: 'g7', version, text } });
  const answers = [(await problems()).map((d) => d.code)];
  for (const step of steps) answers.push(await deeds[step.do](step));
  await connection.sendRequest(lsp.ShutdownRequest.type);
  await connection.sendNotification(lsp.ExitNotification.type);
  const code = await new Promise((done) => server.on('exit', done));
  process.stdout.write(JSON.stringify({ name: hello.serverInfo.name, answers, code }));
}

main().catch((e) => {
  console.error(e);
  server.kill();
  process.exit(1);
});
