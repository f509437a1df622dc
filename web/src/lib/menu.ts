// The keys of a menu: arrows, Home and End go between its buttons, Escape and Tab close it.

/** Handles a key of a menu; `shut` closes it. */
export function menuKey(e: KeyboardEvent, menu: HTMLElement | undefined, shut: () => void): void {
  const all = [...(menu?.querySelectorAll('button') ?? [])];
  const at = all.indexOf(document.activeElement as HTMLButtonElement);
  if (e.key === 'Escape' || e.key === 'Tab') shut();
  else if (e.key === 'ArrowDown') all[(at + 1) % all.length]?.focus();
  else if (e.key === 'ArrowUp') all[(at - 1 + all.length) % all.length]?.focus();
  else if (e.key === 'Home') all[0]?.focus();
  else if (e.key === 'End') all.at(-1)?.focus();
  else return;
  e.preventDefault();
  e.stopPropagation();
}
