// A chapter as the reader shows it: the blocks of its Markdown, with its charts, its question and its exercises found among them.
import { lexer, Lexer, type Token, type Tokens } from 'marked';

/** A possible answer to a question. */
export interface Choice {
  right: boolean;
  text: Token[];
  /** Why it is right or wrong. */
  why: Token[];
}

/** An exercise to which a chapter leads: the name of its folder, and the words of the link. */
export interface Assigned {
  name: string;
  title: string;
}

export type Block =
  | { is: 'words'; token: Token }
  | { is: 'chart'; href: string; caption: string }
  | { is: 'question'; choices: Choice[] }
  | { is: 'exercises'; list: Assigned[] };

/** Separates an answer from its reason. */
const WHY = ' — ';

export function lesson(text: string): Block[] {
  return lexer(text)
    .filter((token) => token.type !== 'space')
    .map(block);
}

function block(token: Token): Block {
  if (token.type === 'list') {
    const { items } = token as Tokens.List;
    if (items.every((item) => item.task)) return { is: 'question', choices: items.map(choice) };
    const list = items.map((item) => (item.tokens.length === 1 ? assigned((item.tokens[0] as Tokens.Text).tokens) : undefined));
    return list.every((one) => one !== undefined) ? { is: 'exercises', list } : { is: 'words', token };
  }
  const tokens = token.type === 'paragraph' ? (token as Tokens.Paragraph).tokens : [];
  const only = alone(tokens);
  if (only?.type === 'image') return { is: 'chart', href: only.href, caption: only.text };
  const one = assigned(tokens);
  return one ? { is: 'exercises', list: [one] } : { is: 'words', token };
}

/** The exercise to which words lead that are a link to its statement and nothing else. */
function assigned(tokens: Token[] = []): Assigned | undefined {
  const only = alone(tokens);
  const name = only?.type === 'link' ? EXERCISE.exec(only.href)?.[1] : undefined;
  return only && name ? { name, title: only.text } : undefined;
}

const EXERCISE = /^..\/..\/exercises\/([^/]+)\/statement\b/;

/** The only part of some words, if it is a picture or a link. */
function alone(tokens: Token[]): Tokens.Image | Tokens.Link | undefined {
  const [one, ...more] = tokens;
  return more.length === 0 && (one?.type === 'image' || one?.type === 'link') ? (one as Tokens.Image | Tokens.Link) : undefined;
}

function choice(item: Tokens.ListItem): Choice {
  const at = item.text.indexOf(WHY);
  const [answer, why] = at < 0 ? [item.text, ''] : [item.text.slice(0, at), item.text.slice(at + WHY.length)];
  return { right: item.checked === true, text: Lexer.lexInline(answer), why: Lexer.lexInline(why) };
}
