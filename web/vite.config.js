import { defineConfig } from 'vite';
import { liveProtocolPlugin } from './protocol.js';

export default defineConfig({
  // Relative addresses: the viewer also works below a path of a reverse proxy.
  base: './',
  plugins: [liveProtocolPlugin()],
  build: {
    target: 'es2022',
    outDir: 'dist',
    // One chunk needs no preload helper, and nothing is inlined because of the strict content security policy.
    modulePreload: false,
    assetsInlineLimit: 0,
    // Size limit of that chunk in kB, uncompressed; compressed it has a quarter of the size.
    chunkSizeWarningLimit: 800,
  },
  // `npm run dev` uses a server on its default port.
  server: {
    proxy: {
      '/api': { target: 'http://127.0.0.1:8080', ws: true },
      '/metrics': 'http://127.0.0.1:8080',
      '/readyz': 'http://127.0.0.1:8080',
    },
  },
});
