// The chapters of the course in English. The browser fetches this file when the start page or the reader first shows the list of chapters.
export const texts = import.meta.glob<string>('../../../../course/*/text.md', { query: '?raw', import: 'default', eager: true });
