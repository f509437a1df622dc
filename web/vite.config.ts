import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vite';

// Relative addresses: the same page is served by `g7 serve` and by any static host.
export default defineConfig({
  base: './',
  plugins: [svelte()],
  build: { target: 'es2022', chunkSizeWarningLimit: 900 },
  worker: { format: 'es' },
  server: {
    host: '127.0.0.1',
    fs: { allow: ['..'] },
    // `g7 serve --port 4700` beside `npm run dev`.
    proxy: { '/api': { target: 'http://127.0.0.1:4700', ws: true } },
  },
});
