// Paths of files, whose parts stand between `/`.

/** The path of a file that lies beside another. */
export function beside(file: string, name: string): string {
  const parts = [...file.split('/').slice(0, -1), ...name.split('/')];
  const kept: string[] = [];
  for (const part of parts) {
    if (part === '..') kept.pop();
    else if (part !== '.' && part !== '') kept.push(part);
  }
  return kept.join('/');
}

/** The name of a file without its folder. */
export const base = (path: string): string => path.slice(path.lastIndexOf('/') + 1);
