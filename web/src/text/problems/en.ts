// The book's pages on problems in English, a part of the page that is fetched when the first of them is asked for.
export const pages = import.meta.glob<string>('../../../../docs/book/src/problems/G*.md', {
  query: '?raw', import: 'default', eager: true,
});
