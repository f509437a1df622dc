// The book's pages on problems in English. The browser fetches this file when a reader opens the first of them.
export const pages = import.meta.glob<string>('../../../../docs/book/src/problems/G*.md', {
  query: '?raw', import: 'default', eager: true,
});
