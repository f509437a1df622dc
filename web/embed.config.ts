import { defineConfig } from 'vite';

// The element for other pages: one script with a name of its own, beside the page that `vite.config.ts` builds.
export default defineConfig({
  publicDir: false,
  build: {
    target: 'es2022',
    emptyOutDir: false,
    lib: { entry: 'src/embed.ts', formats: ['iife'], name: 'g7', fileName: () => 'embed.js' },
  },
});
