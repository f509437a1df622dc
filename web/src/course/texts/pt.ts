// The chapters of the course in Portuguese, a part of the page that is fetched when the list of chapters is shown.
export const texts = import.meta.glob<string>('../../../../course/*/text.pt.md', { query: '?raw', import: 'default', eager: true });
