// The chapters of the course in English. The browser fetches this file when the list of chapters is shown.
export const texts = import.meta.glob<string>('../../../../course/*/text.md', { query: '?raw', import: 'default', eager: true });
