// The book's pages on problems in Portuguese, a part of the page that is fetched when the first of them is asked for.
export const pages = import.meta.glob<string>('../../../../docs/book/pt/problems/G*.md', {
  query: '?raw', import: 'default', eager: true,
});
