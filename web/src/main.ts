import './lib/theme.css';
import { mount } from 'svelte';

// The page of the operator and the editor share few parts: each loads its own.
const page = location.pathname.endsWith('/operator') ? import('./operator/Operator.svelte') : import('./App.svelte');
const target = document.getElementById('app');
if (target) void page.then(({ default: component }) => mount(component, { target }));
