// The little Markdown that explanations are written in, as nodes of the page.

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

export function markdown(text: string): HTMLElement {
  const root = document.createElement('div');
  for (const block of text.trim().split(/\n{2,}/)) {
    if (block.startsWith('```')) {
      root.appendChild(element('pre', block.replace(/^```.*\n?|```$/g, '')));
      continue;
    }
    const heading = /^#+ (.*)/.exec(block);
    const p = document.createElement(heading ? 'strong' : 'p');
    (heading?.[1] ?? block).split(/ {2}\n/).forEach((line, n) => {
      if (n > 0) p.appendChild(document.createElement('br'));
      inline(line.replace(/\n/g, ' '), p);
    });
    root.appendChild(p);
  }
  return root;
}
