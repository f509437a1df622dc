// The part of the `vscode` module that the extension uses, with a record of what it asked for.
const { EventEmitter } = require('node:events');

const did = [];
const commands = new Map();
const settings = { path: 'g7' };

class Uri {
  constructor(text) {
    const url = new URL(text);
    this.scheme = url.protocol.slice(0, -1);
    this.text = text;
    this.fsPath = decodeURIComponent(url.pathname);
  }
  static parse(text) {
    return new Uri(text);
  }
  static file(path) {
    return new Uri(`file://${encodeURI(path)}`);
  }
  toString() {
    return this.text;
  }
}

class Task {
  constructor(definition, scope, name, source, execution) {
    Object.assign(this, { definition, scope, name, source, execution });
  }
}

class ProcessExecution {
  constructor(process, args, options) {
    Object.assign(this, { process, args, options });
  }
}

function panel(kind, title) {
  const events = new EventEmitter();
  const made = {
    kind,
    title,
    shown: [],
    webview: { set html(text) { made.shown.push(text); }, get html() { return made.shown.at(-1); } },
    reveal: () => did.push(['reveal', title]),
    onDidDispose: (f) => events.on('dispose', f),
    dispose: () => events.emit('dispose'),
  };
  did.push(['panel', made]);
  return made;
}

const vscode = {
  Uri,
  Task,
  ProcessExecution,
  TaskScope: { Global: 1, Workspace: 2 },
  TaskRevealKind: { Always: 1 },
  TaskPanelKind: { Dedicated: 2 },
  ViewColumn: { Beside: -2 },
  UIKind: { Desktop: 1, Web: 2 },
  env: { uiKind: 1, asExternalUri: async (uri) => uri },
  workspace: {
    getConfiguration: () => ({ get: (name) => settings[name] }),
    workspaceFolders: undefined,
    getWorkspaceFolder: () => undefined,
    textDocuments: [],
    onDidChangeConfiguration: () => ({ dispose() {} }),
  },
  window: {
    activeTextEditor: undefined,
    showErrorMessage: async (text) => void did.push(['error', text]),
    showInputBox: async () => vscode.window.typed,
    typed: undefined,
    createWebviewPanel: panel,
  },
  commands: {
    registerCommand: (id, f) => {
      commands.set(id, f);
      return { dispose: () => commands.delete(id) };
    },
    executeCommand: async (...args) => void did.push(['command', ...args]),
  },
  tasks: { executeTask: async (task) => void did.push(['task', task]) },
};

module.exports = { vscode, did, commands, settings };
