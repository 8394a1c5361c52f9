import { defineConfig } from 'vite';

// The page is served offline by `haptolith run` under a strict Content-Security-Policy, so the build is a handful of
// plain files: no inline script, no code that is loaded later, relative addresses throughout.
export default defineConfig({
  base: './',
  build: {
    target: 'es2022',
    cssCodeSplit: false,
    modulePreload: false,
    chunkSizeWarningLimit: 1200,
    assetsInlineLimit: 0,
    rollupOptions: {
      output: {
        entryFileNames: 'haptolith.js',
        assetFileNames: 'haptolith[extname]',
        inlineDynamicImports: true,
      },
    },
  },
  // `npm run dev` beside a program or the mock that listens on 8080.
  server: { proxy: { '/ws': { target: 'ws://127.0.0.1:8080', ws: true, changeOrigin: true } } },
});
