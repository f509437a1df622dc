// Words for what the picture editor shows.
import { t, type Key } from '../lib/i18n';
import type { PictureName } from '../lib/protocol';
import type { Offer } from './effects';

const DONE = new Set(['on', 'visible', 'level', 'dx', 'dy', 'rotate', 'opacity', 'text', 'press', 'click']);
const ROLES: Record<PictureName['role'], Key> = {
  state: 'picture.state',
  const: 'picture.const',
  parts: 'picture.queue',
  output: 'picture.output',
  input: 'picture.input',
};

/** What an effect does, and to which element of its part. */
export function effectName({ attribute, element }: Offer): string {
  const does = DONE.has(attribute) ? t(`picture.do.${attribute}` as Key) : attribute;
  return element === null || attribute === 'press' || attribute === 'click' ? does : `${does} (${element})`;
}

export const roleName = (name: PictureName): string => t(ROLES[name.role]);
