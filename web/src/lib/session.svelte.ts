// Who uses the page: a user of the server with a role, or whoever has the token of its start.
import { t } from './i18n';
import { prefs } from './prefs.svelte';

export type Role = 'viewer' | 'operator' | 'engineer' | 'admin';
export const ROLES: readonly Role[] = ['viewer', 'operator', 'engineer', 'admin'];

interface Told {
  /** The server has users, and they log in. */
  users: boolean;
  /** There is no admin yet. */
  first?: boolean;
  user?: { name: string; role: Role } | null;
  /** Whoever has the address for guests: looks and changes nothing. */
  guest?: boolean;
  /** What people do is written down. */
  log?: boolean;
}

const TOKEN = 'g7-token';

/** The token of the page's address; it is kept for the window and taken out of the address. */
function takeToken(): string {
  const here = new URL(location.href);
  const token = here.searchParams.get('token');
  if (token) {
    here.searchParams.delete('token');
    history.replaceState(null, '', here);
  }
  try {
    if (token) sessionStorage.setItem(TOKEN, token);
    return sessionStorage.getItem(TOKEN) ?? '';
  } catch {
    // In a frame of another page there may be no storage.
    return token ?? '';
  }
}

let token: string | null = null;

/** The token of this window. */
export function ownToken(): string {
  token ??= takeToken();
  return token;
}

/** The language of the page, for what the server refuses. */
function spoken(): Record<string, string> {
  return { 'accept-language': prefs.language };
}

class Session {
  told: Told = $state.raw({ users: false });
  /** True if someone has to log in first. */
  readonly asks = $derived(this.told.users && !this.told.user);

  async begin(): Promise<void> {
    const headers = { authorization: `Bearer ${ownToken()}` };
    const answer = await fetch(new URL('api/session', document.baseURI), { headers }).catch(() => null);
    if (answer?.ok && answer.headers.get('content-type')?.includes('json')) this.told = (await answer.json()) as Told;
  }

  /** Without users whoever is here may do everything, but for guests. */
  may(role: Role): boolean {
    const has = this.told.user?.role;
    return (!this.told.users && !this.told.guest) || (has !== undefined && ROLES.indexOf(has) >= ROLES.indexOf(role));
  }

  /** Why something is not available: the role that it needs; nothing where the user has it. */
  lacks(role: Role): string | undefined {
    return this.may(role) ? undefined : t('ac.needs', { role: t(`ac.role.${role}`) });
  }

  /** Sends something to the server; the reason where it is refused. */
  async send(path: string, body: unknown): Promise<string> {
    try {
      const init = { method: 'POST', headers: { 'content-type': 'application/json', ...spoken() }, body: JSON.stringify(body) };
      const answer = await fetch(new URL(`api/${path}`, document.baseURI), init);
      return answer.ok ? '' : (await answer.text()) || answer.statusText;
    } catch {
      return t('ac.unreachable');
    }
  }

  async get<T>(path: string): Promise<{ ok: T } | { no: string }> {
    try {
      const answer = await fetch(new URL(`api/${path}`, document.baseURI), { headers: spoken() });
      if (answer.ok) return { ok: (await answer.json()) as T };
      return { no: (await answer.text()) || answer.statusText };
    } catch {
      return { no: t('ac.unreachable') };
    }
  }

  async leave(): Promise<void> {
    await this.send('logout', {});
    location.reload();
  }
}

export const session = new Session();
