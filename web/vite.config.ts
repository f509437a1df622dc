import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vite';

// Relative addresses, so that `g7 serve` and any static host can serve the same page.
export default defineConfig({
  base: './',
  plugins: [svelte()],
  build: { target: 'es2022', chunkSizeWarningLimit: 900 },
  worker: { format: 'es' },
  server: {
    host: '127.0.0.1',
    fs: { allow: ['..'] },
    // For `npm run dev` together with `g7 serve --port 4700`.
    proxy: { '/api': { target: 'http://127.0.0.1:4700', ws: true } },
  },
});
