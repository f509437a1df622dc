// The texts of problems in French and Portuguese, a part of the page that is fetched when one of these languages is
// chosen: the modules of wasm have the English texts alone (decision 55).
const tables = import.meta.glob<string>('../../../crates/model/src/said/*.txt', { query: '?raw', import: 'default', eager: true });

export const texts = Object.values(tables).join('\n');
