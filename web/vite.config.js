import { defineConfig } from 'vite';
import { liveProtocolPlugin } from './protocol.js';

export default defineConfig({
  // Relative addresses: the viewer also works below a path of a reverse proxy.
  base: './',
  plugins: [liveProtocolPlugin()],
  build: {
    target: 'es2022',
    outDir: 'dist',
    // One chunk needs no preload helper, and nothing is inlined: the page obeys a strict content security policy.
    modulePreload: false,
    assetsInlineLimit: 0,
    // Of that one chunk, in kB as it is; sent, it is a quarter.
    chunkSizeWarningLimit: 800,
  },
  // `npm run dev` shows a server that runs on its usual port.
  server: {
    proxy: {
      '/api': { target: 'http://127.0.0.1:8080', ws: true },
      '/metrics': 'http://127.0.0.1:8080',
      '/readyz': 'http://127.0.0.1:8080',
    },
  },
});
