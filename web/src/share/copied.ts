// Copies a text, and says so.
import { t } from '../lib/i18n';
import { shell } from '../lib/shell.svelte';

export async function copy(text: string): Promise<void> {
  await navigator.clipboard.writeText(text);
  shell.say(t('share.copied'));
}
