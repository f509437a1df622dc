// The recently opened files, kept by the browser.

const RECENT = 'g7-recent';
const MOST = 8;

function stored(): string[] {
  try {
    const found: unknown = JSON.parse(localStorage.getItem(RECENT) ?? '[]');
    return Array.isArray(found) ? found.filter((f): f is string => typeof f === 'string') : [];
  } catch {
    return [];
  }
}

class Recent {
  names: string[] = $state.raw(stored());

  add(name: string): void {
    if (this.names[0] === name) return;
    this.names = [name, ...this.names.filter((n) => n !== name)].slice(0, MOST);
    try {
      localStorage.setItem(RECENT, JSON.stringify(this.names));
    } catch {
      // This list is only a convenience, so a failure is ignored.
    }
  }
}

export const recent = new Recent();
