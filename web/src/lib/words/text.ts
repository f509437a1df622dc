import type { Words } from '../i18n';

export const text = {
} as const satisfies Words;
