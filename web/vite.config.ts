import { readdirSync, readFileSync } from 'node:fs';
import { defineConfig, type Plugin } from 'vite';
import own from './package.json' with { type: 'json' };
import { protocolSource } from './resolve.config';

// Writes licences.txt next to the page: the licences of the bundled packages.
function licences(): Plugin {
  return {
    name: 'licences',
    generateBundle() {
      const texts = Object.entries(own.dependencies).map(([name, version]) => {
        const folder = new URL(`./node_modules/${name}/`, import.meta.url);
        const file = readdirSync(folder).find((entry) => /^licen[cs]e(\.\w+)?$/i.test(entry));
        if (file === undefined) throw new Error(`${name} says nothing about its licence`);
        return `${name} ${version}\n\n${readFileSync(new URL(file, folder), 'utf8').trim()}\n`;
      });
      this.emitFile({ type: 'asset', fileName: 'licences.txt', source: texts.join(`\n${'-'.repeat(78)}\n\n`) });
    },
  };
}

// The page is served offline by `haptolith run` under a strict Content-Security-Policy. The build is therefore a few
// plain files: no inline script, no code loaded later, relative addresses throughout.
export default defineConfig({
  base: './',
  ...protocolSource,
  plugins: [licences()],
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
  // `npm run dev` with a program or the mock that listens on 8080.
  server: { proxy: { '/ws': { target: 'ws://127.0.0.1:8080', ws: true } } },
});
