// A chapter as the reader shows it: the blocks of its Markdown, with its charts, its question and its exercises found among them.
import { lexer, Lexer, type Token, type Tokens } from 'marked';

/** A possible answer to a question. */
export interface Choice {
  right: boolean;
  text: Token[];
  /** Why it is right or wrong. */
  why: Token[];
}

export type Block =
  | { is: 'words'; token: Token }
  | { is: 'chart'; href: string; caption: string }
  | { is: 'question'; choices: Choice[] }
  | { is: 'exercise'; name: string; title: string };

/** Separates an answer from its reason. */
const WHY = ' — ';


export function lesson(text: string): Block[] {
  return lexer(text)
    .filter((token) => token.type !== 'space')
    .map(block);
}

function block(token: Token): Block {
  if (token.type === 'list' && (token as Tokens.List).items.every((item) => item.task)) return { is: 'question', choices: (token as Tokens.List).items.map(choice) };
  const only = token.type === 'paragraph' ? alone((token as Tokens.Paragraph).tokens) : undefined;
  if (only?.type === 'image') return { is: 'chart', href: only.href, caption: only.text };
  const exercise = only?.type === 'link' && EXERCISE.exec(only.href)?.[1];
  if (only && exercise) return { is: 'exercise', name: exercise, title: only.text };
  return { is: 'words', token };
}

const EXERCISE = /^..\/..\/exercises\/([^/]+)\/statement\b/;

/** The only part of a paragraph, if it is a picture or a link. */
function alone(tokens: Token[]): Tokens.Image | Tokens.Link | undefined {
  const [one, ...more] = tokens;
  return more.length === 0 && (one?.type === 'image' || one?.type === 'link') ? (one as Tokens.Image | Tokens.Link) : undefined;
}

function choice(item: Tokens.ListItem): Choice {
  const at = item.text.indexOf(WHY);
  const [answer, why] = at < 0 ? [item.text, ''] : [item.text.slice(0, at), item.text.slice(at + WHY.length)];
  return { right: item.checked === true, text: Lexer.lexInline(answer), why: Lexer.lexInline(why) };
}
