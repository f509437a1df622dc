// The rules for the CSS of pictures, without a browser: nothing from elsewhere, however it is written.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { inside } from '../src/run/css';

test('no way of writing CSS loads something from elsewhere', () => {
  for (const css of [
    'fill: url(http://example.org/a)',
    'fill: u\\72l(http://example.org/a)',
    'fill: \\75\\72\\6c(http://example.org/a)',
    'fill: \\000075rl( "http://example.org/a" )',
    'fill: U\\52 L(//example.org/a)',
    "fill: url(/* # */ '//example.org/a')",
    'fill: url(\\23/../a.svg) url(a#b)',
    "fill: image-set('a.png' 1x)",
    "fill: -webkit-image-s\\65t('a.png' 1x)",
    "fill: src('a.png')",
    "fill: src(var(--a))",
    "fill: image('a.png')",
    "fill: cross-fade(url(#a), 'b')",
    "--a: u\\72l(//example.org); fill: var(--a)",
    "@import 'a.css';",
    "@\\69mport 'a.css';",
    "@font-face { font-family: a; src: local(a) }",
    '@namespace svg url(#a);',
    'fill: url(a b)',
    "fill: 'a\nb'",
    'width: expression(1)',
    'fill: not-known-yet(a)',
  ]) {
    assert.equal(inside(css), false, css);
  }
});

test('the parts of a picture and usual values stay', () => {
  for (const css of [
    '',
    'url(#a)',
    'url( "#a" )',
    'u\\72l(#a)',
    'translate(3, 4) rotate(45)',
    'M0 0 L 10 10 Z',
    '.on { fill: color-mix(in srgb, lime 40%, var(--x)); transform: scaleX(calc(1 - 0.5)) }',
    '@media (prefers-color-scheme: dark) { a:not(.b) { transition: fill 1s cubic-bezier(0, 0, 1, 1) } }',
    '@keyframes a { from { opacity: 0 } }',
    '/* url(http://example.org) */ fill: red',
    'http://example.org',
  ]) {
    assert.ok(inside(css), css);
  }
});

test('the pictures of the examples are whole', () => {
  const root = new URL('../../examples/', import.meta.url).pathname;
  const all = readdirSync(root, { recursive: true, encoding: 'utf8' }).filter((name) => name.endsWith('.svg'));
  assert.ok(all.length > 5);
  for (const name of all) {
    const text = readFileSync(join(root, name), 'utf8');
    for (const [, css] of text.matchAll(/<style[^>]*>([\s\S]*?)<\/style>/g)) assert.ok(inside(css ?? ''), name);
    for (const [, name, value] of text.matchAll(/ ([\w-]+)="([^"]*)"/g)) {
      if (!/^(data-|aria-|xmlns)/.test(name ?? '')) assert.ok(inside(value ?? ''), `${name}="${value}"`);
    }
  }
});
