import type { Words } from '../i18n';

export const canvas = {
} as const satisfies Words;
