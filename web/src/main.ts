import './lib/theme.css';
import { mount } from 'svelte';
import { session } from './lib/session.svelte';

// The page of the operator and the editor share few parts: each loads its own. Where users log in, the form
// comes first.
const page = location.pathname.endsWith('/operator') ? import('./operator/Operator.svelte') : import('./App.svelte');
const target = document.getElementById('app');

async function begin(target: HTMLElement): Promise<void> {
  await session.begin();
  const { default: component } = session.asks ? await import('./access/Login.svelte') : await page;
  mount(component, { target });
}

if (target) void begin(target);
