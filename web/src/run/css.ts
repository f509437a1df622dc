// CSS of a picture from a file: it may name its own parts, and nothing from elsewhere. The tokens are those of the
// library, so that an escape or a comment hides nothing.
import { isTokenAtKeyword, isTokenBadString, isTokenBadURL, isTokenFunction, isTokenString, isTokenURL, isTokenWhiteSpaceOrComment, tokenize, type CSSToken } from '@csstools/css-tokenizer';

const RULES = new Set('media supports layer keyframes -webkit-keyframes property container'.split(' '));

/** The functions that load nothing. One that is not known is refused. */
const FUNCTIONS = new Set(
  `rgb rgba hsl hsla hwb lab lch oklab oklch color color-mix light-dark
  calc min max clamp round mod rem sin cos tan asin acos atan atan2 pow sqrt hypot log exp abs sign var env
  translate translatex translatey translatez translate3d scale scalex scaley scalez scale3d
  rotate rotatex rotatey rotatez rotate3d skew skewx skewy matrix matrix3d perspective
  blur brightness contrast drop-shadow grayscale hue-rotate invert opacity saturate sepia
  linear-gradient radial-gradient conic-gradient repeating-linear-gradient repeating-radial-gradient repeating-conic-gradient
  cubic-bezier steps linear circle ellipse inset polygon path rect xywh ray
  not is where has nth-child nth-last-child nth-of-type nth-last-of-type lang dir host counter counters`.split(/\s+/),
);

/** True if a piece of CSS refers to nothing but parts of the picture itself. */
export function inside(css: string): boolean {
  const tokens = tokenize({ css }).filter((token) => !isTokenWhiteSpaceOrComment(token));
  return tokens.every((token, at) => harmless(token, tokens[at + 1]));
}

function harmless(token: CSSToken, next: CSSToken | undefined): boolean {
  if (isTokenBadURL(token) || isTokenBadString(token)) return false;
  if (isTokenURL(token)) return token[4].value.startsWith('#');
  if (isTokenAtKeyword(token)) return RULES.has(token[4].value.toLowerCase());
  if (!isTokenFunction(token)) return true;
  const name = token[4].value.toLowerCase();
  if (name === 'url') return next !== undefined && isTokenString(next) && next[4].value.startsWith('#');
  return FUNCTIONS.has(name);
}
