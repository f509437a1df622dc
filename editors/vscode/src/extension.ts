// The extension: it starts `g7 lsp`, and carries out the commands that the server offers above charts and
// tests. It knows nothing of charts itself.

import { execFile } from 'node:child_process';
import * as path from 'node:path';
import { promisify } from 'node:util';
import * as vscode from 'vscode';
import { LanguageClient, type LanguageClientOptions, type ServerOptions } from 'vscode-languageclient/node';
import { Drawings } from './drawings';
import { lineOf, type Work } from './lines';

let client: LanguageClient | undefined;

/** The program as set; a path within the workspace folder may begin with a dot. */
export function program(): string {
  const set = vscode.workspace.getConfiguration('g7').get<string>('path')?.trim() || 'g7';
  const root = vscode.workspace.workspaceFolders?.[0]?.uri.fsPath;
  return set.startsWith('.') && root !== undefined ? path.resolve(root, set) : set;
}

/** Asks the program for its version, so that a program that is missing is told once, with the way out. */
async function starts(): Promise<void> {
  await promisify(execFile)(program(), ['--version']);
}

async function startClient(): Promise<void> {
  const server: ServerOptions = { command: program(), args: ['lsp'] };
  const options: LanguageClientOptions = {
    documentSelector: [
      { scheme: 'file', language: 'g7' },
      { scheme: 'untitled', language: 'g7' },
    ],
  };
  try {
    await starts();
    client = new LanguageClient('g7', 'G7', server, options);
    await client.start();
  } catch (e) {
    client = undefined;
    const settings = 'Open Settings';
    const chosen = await vscode.window.showErrorMessage(
      `\`${program()} lsp\` cannot be started: ${e instanceof Error ? e.message : String(e)}. Install G7, or set its path.`,
      settings,
    );
    if (chosen === settings) await vscode.commands.executeCommand('workbench.action.openSettings', 'g7.path');
  }
}

async function stopClient(): Promise<void> {
  const old = client;
  client = undefined;
  await old?.stop();
}

/** The file of a command: that of its argument, else that of the editor in front. */
async function fileOf(uri: unknown): Promise<string | undefined> {
  const named = typeof uri === 'string' ? vscode.Uri.parse(uri) : uri instanceof vscode.Uri ? uri : undefined;
  const at = named ?? vscode.window.activeTextEditor?.document.uri;
  if (at === undefined || at.scheme !== 'file') {
    void vscode.window.showErrorMessage('G7 works on files: save the chart first.');
    return undefined;
  }
  // The text on the screen is the one that is run.
  const open = vscode.workspace.textDocuments.find((d) => d.uri.toString() === at.toString());
  if (open?.isDirty && !(await open.save())) return undefined;
  return at.fsPath;
}

async function inTerminal(work: Work, uri: unknown, name: unknown): Promise<void> {
  const file = await fileOf(uri);
  if (file === undefined) return;
  const { title, args } = lineOf(work, file, typeof name === 'string' ? name : '');
  const folder = vscode.workspace.getWorkspaceFolder(vscode.Uri.file(file));
  const task = new vscode.Task(
    { type: 'g7', work },
    folder ?? vscode.TaskScope.Workspace,
    title,
    'G7',
    new vscode.ProcessExecution(program(), args, { cwd: path.dirname(file) }),
  );
  task.presentationOptions = { reveal: vscode.TaskRevealKind.Always, panel: vscode.TaskPanelKind.Dedicated, clear: true };
  await vscode.tasks.executeTask(task);
}

/** Has the language server show the values of the runs of a server; without an address of none. */
async function follow(address: string): Promise<void> {
  try {
    // The client has registered this command of the language server.
    await vscode.commands.executeCommand('g7.follow', address);
  } catch (e) {
    if (address !== '') void vscode.window.showErrorMessage(`No values can be shown: ${e instanceof Error ? e.message : String(e)}`);
  }
}

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  const drawings = new Drawings(program, follow);
  const command = (id: string, does: (...args: unknown[]) => Promise<void>) =>
    context.subscriptions.push(vscode.commands.registerCommand(id, does));
  for (const work of ['run', 'test', 'prove'] as const) {
    command(`g7.${work}`, (uri, name) => inTerminal(work, uri, name));
  }
  command('g7.draw', async (uri) => {
    const file = await fileOf(uri);
    if (file !== undefined) await drawings.show(file);
  });
  command('g7.values', async () => {
    const prompt = 'The address that `g7 serve` prints; none to show no values';
    const address = await vscode.window.showInputBox({ prompt, placeHolder: 'http://127.0.0.1:4700/?token=…' });
    if (address !== undefined) await follow(address.trim());
  });
  command('g7.restart', async () => {
    await stopClient();
    await startClient();
  });
  context.subscriptions.push(drawings);
  context.subscriptions.push(
    vscode.workspace.onDidChangeConfiguration(async (e) => {
      if (!e.affectsConfiguration('g7.path')) return;
      await stopClient();
      await startClient();
    }),
  );
  await startClient();
}

export async function deactivate(): Promise<void> {
  await stopClient();
}
