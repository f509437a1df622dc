// The command lines of the program.

import * as path from 'node:path';

/** What is done in a terminal. */
export type Work = 'run' | 'test' | 'prove';

/** The title of a task, and the arguments of `g7`. */
export function lineOf(work: Work, file: string, name: string): { title: string; args: string[] } {
  const args = [work, file];
  if (work === 'test' && name !== '') args.push('--filter', name);
  if (work === 'prove') args.push('--all');
  const what = work === 'test' && name !== '' ? name : path.basename(file);
  return { title: `${work} ${what}`, args };
}

/** The arguments of the server whose page is shown in a panel; the address is that of a VS Code in the browser. */
export function serveLine(folder: string, editor: string): string[] {
  return ['serve', folder, '--no-open', editor === '' ? '--framed' : `--framed=${editor}`];
}

/** True for an address of this machine. */
export function isHere(address: URL): boolean {
  return ['127.0.0.1', 'localhost', '[::1]'].includes(address.hostname);
}

/** The address that the server has printed, if it is one of this machine. */
export function addressIn(printed: string): URL | undefined {
  const line = printed.split('\n').find((l) => /^http:\/\/(127\.0\.0\.1|localhost|\[::1\]):\d+\/\S*\r?$/.test(l));
  return line === undefined ? undefined : new URL(line.trim());
}

/** The address of a file on the page, by its path within the folder. */
export function pageOf(address: URL, folder: string, file: string): string {
  const page = new URL(address);
  page.searchParams.set('file', path.relative(folder, file).split(path.sep).join('/'));
  return page.toString();
}
