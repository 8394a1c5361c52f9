import { mergeConfig } from 'vite';
import page from './vite.config';

// The page with the soil in it, as a folder that any web server or file host serves: ./dev demo. What somebody has put
// into the folder, a film for one, stays there.
export default mergeConfig(page, {
  worker: {
    format: 'iife', // takes the compiler's script in with importScripts()
    rollupOptions: { output: { entryFileNames: 'worker.js' } },
  },
  build: { emptyOutDir: false, rollupOptions: { input: 'demo.html' } },
});
