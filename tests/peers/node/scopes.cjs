// The scopes that a TextMate grammar gives to parts of texts. Standard input: { grammar, onig, texts: [{ text,
// asks: [[start, end]] }] } with places in UTF-16 units; standard output: for each text the scopes of each part,
// those of its first unit and, if they differ, those of its last one behind `|`.
const { readFileSync } = require('node:fs');
const { join, dirname } = require('node:path');
const { loadWASM, OnigScanner, OnigString } = require('vscode-oniguruma');
const { INITIAL, Registry, parseRawGrammar } = require('vscode-textmate');

async function main() {
  const asked = JSON.parse(readFileSync(0, 'utf8'));
  await loadWASM(readFileSync(join(dirname(require.resolve('vscode-oniguruma')), 'onig.wasm')));
  const registry = new Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new OnigScanner(patterns),
      createOnigString: (text) => new OnigString(text),
    }),
    loadGrammar: async () => parseRawGrammar(readFileSync(asked.grammar, 'utf8'), asked.grammar),
  });
  const grammar = await registry.loadGrammar('source.g7');
  const answer = asked.texts.map(({ text, asks }) => {
    const units = new Array(text.length).fill('');
    let stack = INITIAL;
    let at = 0;
    for (const line of text.split('\n')) {
      const { tokens, ruleStack } = grammar.tokenizeLine(line, stack);
      stack = ruleStack;
      for (const t of tokens) {
        const scopes = t.scopes.slice(1).join(' ');
        for (let i = t.startIndex; i < Math.min(t.endIndex, line.length); i++) units[at + i] = scopes;
      }
      at += line.length + 1;
    }
    return asks.map(([start, end]) => (units[start] === units[end - 1] ? units[start] : `${units[start]}|${units[end - 1]}`));
  });
  process.stdout.write(JSON.stringify(answer));
}

main();
