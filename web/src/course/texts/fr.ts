// The chapters of the course in French, a part of the page that is fetched when the list of chapters is shown.
export const texts = import.meta.glob<string>('../../../../course/*/text.fr.md', { query: '?raw', import: 'default', eager: true });
