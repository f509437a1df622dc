import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vite';

const here = (file: string) => new URL(file, import.meta.url).pathname;

export default defineConfig({
  root: here('.'),
  base: './',
  publicDir: here('../public'),
  plugins: [svelte({ configFile: here('../svelte.config.js') })],
  resolve: { dedupe: ['react', 'react-dom'] },
  worker: { format: 'es' },
  build: { target: 'es2022', rolldownOptions: { input: { g7: here('g7.html'), flow: here('flow.html') } }, chunkSizeWarningLimit: 2000 },
});
