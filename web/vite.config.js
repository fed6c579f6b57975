import { defineConfig } from 'vite';

export default defineConfig({
  // Relative addresses: the viewer also works below a path of a reverse proxy.
  base: './',
  build: {
    target: 'es2022',
    outDir: 'dist',
    // One chunk needs no preload helper, and nothing is inlined: the page obeys a strict content security policy.
    modulePreload: false,
    assetsInlineLimit: 0,
  },
  // `npm run dev` shows a server that runs on its usual port.
  server: {
    proxy: {
      '/api': 'http://127.0.0.1:8080',
      '/metrics': 'http://127.0.0.1:8080',
      '/readyz': 'http://127.0.0.1:8080',
    },
  },
});
