// Files that were open lately, and work that was not saved before the page was
// left: both kept by the browser.

const RECENT = 'g7-recent';
const DRAFT = 'g7-draft:';
const MOST = 8;

function stored(): string[] {
  try {
    const found: unknown = JSON.parse(localStorage.getItem(RECENT) ?? '[]');
    return Array.isArray(found) ? found.filter((f): f is string => typeof f === 'string') : [];
  } catch {
    return [];
  }
}

export interface Draft {
  name: string;
  text: string;
}

function drafts(): Draft[] {
  const found: Draft[] = [];
  try {
    for (let n = 0; n < localStorage.length; n++) {
      const key = localStorage.key(n);
      if (!key?.startsWith(DRAFT)) continue;
      found.push({ name: key.slice(DRAFT.length), text: localStorage.getItem(key) ?? '' });
    }
  } catch {
    // A browser that keeps nothing has nothing.
  }
  return found.sort((a, b) => (a.name < b.name ? -1 : 1));
}

class Recent {
  names: string[] = $state.raw(stored());
  /** As they were when the page was opened. */
  drafts: Draft[] = $state.raw(drafts());

  add(name: string): void {
    if (this.names[0] === name) return;
    this.names = [name, ...this.names.filter((n) => n !== name)].slice(0, MOST);
    try {
      localStorage.setItem(RECENT, JSON.stringify(this.names));
    } catch {
      // It is a convenience only.
    }
  }

  drop(name: string): void {
    this.drafts = this.drafts.filter((d) => d.name !== name);
    try {
      localStorage.removeItem(DRAFT + name);
    } catch {
      // Nothing was kept.
    }
  }
}

export const recent = new Recent();
