import type { Words } from '../i18n';

export const run = {
} as const satisfies Words;
