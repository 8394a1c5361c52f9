import { defineConfig } from 'vite';
import { protocolSource } from './resolve.config';
import { licences } from './vite.config';

// The page with the soil in it, as a folder that any web server or file host serves: ./dev demo.
export default defineConfig({
  base: './',
  ...protocolSource,
  plugins: [licences()],
  worker: {
    format: 'iife', // takes the compiler's script in with importScripts()
    rollupOptions: { output: { entryFileNames: 'worker.js' } },
  },
  build: {
    target: 'es2022',
    cssCodeSplit: false,
    modulePreload: false,
    chunkSizeWarningLimit: 1200,
    assetsInlineLimit: 0,
    rollupOptions: {
      input: 'demo.html',
      output: { entryFileNames: 'haptolith.js', assetFileNames: 'haptolith[extname]', inlineDynamicImports: true },
    },
  },
});
