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
  /** What people do is written down. */
  log?: boolean;
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
    const answer = await fetch(new URL('api/session', document.baseURI)).catch(() => null);
    if (answer?.ok && answer.headers.get('content-type')?.includes('json')) this.told = (await answer.json()) as Told;
  }

  /** Without users whoever is here may do everything. */
  may(role: Role): boolean {
    const has = this.told.user?.role;
    return !this.told.users || (has !== undefined && ROLES.indexOf(has) >= ROLES.indexOf(role));
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
