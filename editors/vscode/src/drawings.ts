// The drawing beside the text: a panel that shows the page of `g7 serve`, one server for a folder. The server
// listens on this machine alone, and ends with its last panel.

import { type ChildProcess, spawn } from 'node:child_process';
import * as path from 'node:path';
import * as vscode from 'vscode';
import { addressIn, isHere, pageOf, serveLine } from './lines';

/** How long a server may take to print its address, in milliseconds. */
const PATIENCE = 20_000;

interface Server {
  folder: string;
  process: ChildProcess;
  address: Promise<URL>;
  panels: Set<vscode.WebviewPanel>;
}

/** The panels, and the servers behind them. */
export class Drawings implements vscode.Disposable {
  private servers = new Map<string, Server>();
  private panels = new Map<string, vscode.WebviewPanel>();

  /** `follow` is given the address of each server, and an empty one as it ends. */
  constructor(private program: () => string, private follow: (address: string) => Promise<void>) {}

  /** Shows the page of a file; a panel that is there comes to the front. */
  async show(file: string): Promise<void> {
    const old = this.panels.get(file);
    if (old !== undefined) {
      old.reveal(undefined, true);
      return;
    }
    const folder = vscode.workspace.getWorkspaceFolder(vscode.Uri.file(file))?.uri.fsPath ?? path.dirname(file);
    const panel = vscode.window.createWebviewPanel(
      'g7.drawing',
      path.basename(file),
      { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true },
      { enableScripts: true, retainContextWhenHidden: true },
    );
    this.panels.set(file, panel);
    panel.webview.html = page('', 'The page is being started …');
    const editor = await editorAddress();
    const server = this.serve(folder, editor);
    server.panels.add(panel);
    panel.onDidDispose(() => {
      this.panels.delete(file);
      server.panels.delete(panel);
      if (server.panels.size === 0) this.end(server);
    });
    try {
      panel.webview.html = page(await seenAt(new URL(pageOf(await server.address, folder, file)), editor), '');
    } catch (e) {
      panel.webview.html = page('', e instanceof Error ? e.message : String(e));
    }
  }

  private serve(folder: string, editor: string): Server {
    const running = this.servers.get(folder);
    if (running !== undefined) return running;
    const process = spawn(this.program(), serveLine(folder, editor), { stdio: ['ignore', 'pipe', 'pipe'] });
    const server: Server = { folder, process, address: this.addressOf(process), panels: new Set() };
    process.on('exit', () => {
      if (this.servers.get(folder) === server) this.servers.delete(folder);
      for (const panel of server.panels) panel.webview.html = page('', 'The server of the drawing has ended. Close this panel and open the drawing again.');
    });
    this.servers.set(folder, server);
    // A failure is told in the panel.
    server.address.then((address) => this.follow(address.toString()), () => undefined);
    return server;
  }

  private addressOf(process: ChildProcess): Promise<URL> {
    return new Promise((done, failed) => {
      let printed = '';
      let told = '';
      const late = setTimeout(() => failed(new Error(`The page did not start. ${told}`)), PATIENCE);
      const ends = (why: string) => {
        clearTimeout(late);
        failed(new Error(why));
      };
      process.on('error', (e) => ends(`\`${this.program()} serve\` cannot be started: ${e.message}`));
      process.on('exit', (code) => ends(`\`g7 serve\` ended with code ${code}. ${told}`));
      process.stderr?.on('data', (data: Buffer) => {
        told = (told + data.toString()).slice(-2000);
      });
      process.stdout?.on('data', (data: Buffer) => {
        printed += data.toString();
        const address = printed.includes('\n') ? addressIn(printed) : undefined;
        if (address !== undefined) {
          clearTimeout(late);
          done(address);
        }
      });
    });
  }

  private end(server: Server): void {
    if (this.servers.get(server.folder) === server) this.servers.delete(server.folder);
    server.process.kill('SIGINT');
    void this.follow('');
  }

  dispose(): void {
    for (const panel of [...this.panels.values()]) panel.dispose();
    for (const server of [...this.servers.values()]) this.end(server);
  }
}

/** The address of a VS Code that is itself a page of this machine; empty on a desktop. */
async function editorAddress(): Promise<string> {
  if (vscode.env.uiKind !== vscode.UIKind.Web) return '';
  const outside = new URL((await vscode.env.asExternalUri(vscode.Uri.parse('http://127.0.0.1:1/'))).toString(true));
  return isHere(outside) ? outside.origin : '';
}

/** The address under which this window reaches a page of the server, which answers under its own name alone. */
async function seenAt(page: URL, editor: string): Promise<string> {
  if (editor !== '') return page.toString();
  // Where the folder is on another machine, VS Code passes the port on.
  const outside = new URL((await vscode.env.asExternalUri(vscode.Uri.parse(page.toString()))).toString(true));
  if (isHere(outside) && outside.port === page.port) return outside.toString();
  throw new Error(`The page is at ${outside.origin} in this window, where its server does not answer. Forward port ${page.port} to the same port of your machine.`);
}

function escaped(text: string): string {
  return text.replace(/[&<>"']/g, (c) => `&#${c.charCodeAt(0)};`);
}

/** The page of a panel: the address in a frame, or words. */
function page(address: string, words: string): string {
  const origin = address === '' ? "'none'" : new URL(address).origin;
  const body = address === '' ? `<p>${escaped(words)}</p>` : `<iframe src="${escaped(address)}" allow="clipboard-read; clipboard-write; fullscreen"></iframe>`;
  return `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; frame-src ${origin}; style-src 'unsafe-inline'">
<style>html, body { height: 100%; margin: 0; padding: 0; overflow: hidden } iframe { border: 0; width: 100%; height: 100% } p { padding: 1em }</style>
</head>
<body>${body}</body>
</html>`;
}
