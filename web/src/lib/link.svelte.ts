// The connection to the server, as the page shows it.

/** The server is there; nobody answers; one answers that does not know this page; another folder is served; the same
 * folder by another version of the program. */
export type Linked = 'up' | 'gone' | 'strange' | 'other' | 'newer';

class Link {
  state: Linked = $state('up');
  /** The browser keeps no copies: its storage is full, or closed to the page. */
  full = $state(false);
}

export const link = new Link();
