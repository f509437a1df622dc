// Converts the small part of Markdown that explanations use to nodes of the page.

function inline(text: string, into: HTMLElement): void {
  for (const part of text.split(/(`[^`]+`|\*\*[^*]+\*\*)/)) {
    if (part.startsWith('`') && part.length > 2) into.appendChild(element('code', part.slice(1, -1)));
    else if (part.startsWith('**') && part.length > 4) into.appendChild(element('strong', part.slice(2, -2)));
    else into.append(part);
  }
}

function element(name: string, text: string): HTMLElement {
  const made = document.createElement(name);
  made.textContent = text;
  return made;
}

/** Code between fences; a chart that is wrong on purpose is marked. */
function code(block: string): HTMLElement {
  const [, kind = '', text = ''] = /^```(.*)\n([\s\S]*?)\n?```$/.exec(block) ?? [];
  const pre = element('pre', text);
  if (kind.includes('wrong')) pre.className = 'wrong';
  pre.tabIndex = 0;
  return pre;
}

function list(block: string): HTMLElement {
  const ul = document.createElement('ul');
  for (const item of block.split(/^[-*] /m).filter((line) => line.trim() !== '')) {
    const li = document.createElement('li');
    inline(item.trim().replace(/\s*\n\s*/g, ' '), li);
    ul.appendChild(li);
  }
  return ul;
}

function paragraph(block: string): HTMLElement {
  const heading = /^#+ (.*)/.exec(block);
  const p = document.createElement(heading ? 'h3' : 'p');
  (heading?.[1] ?? block).split(/ {2}\n/).forEach((line, n) => {
    if (n > 0) p.appendChild(document.createElement('br'));
    inline(line.replace(/\n/g, ' '), p);
  });
  return p;
}

export function markdown(text: string): HTMLElement {
  const root = document.createElement('div');
  for (const part of text.trim().split(/^(```[\s\S]*?^```$)/m)) {
    if (part.startsWith('```')) root.appendChild(code(part));
    else for (const block of part.split(/\n{2,}/).map((b) => b.trim())) {
      if (block !== '') root.appendChild(/^[-*] /.test(block) ? list(block) : paragraph(block));
    }
  }
  return root;
}
