import { mergeConfig } from 'vite';
import page from './vite.config';

// The page with the soil inside, as a folder that any web server or file host can serve: ./dev demo. Other files in the
// folder, for example an animation, are kept.
export default mergeConfig(page, {
  worker: {
    format: 'iife', // loads the compiler's script with importScripts()
    rollupOptions: { output: { entryFileNames: 'worker.js' } },
  },
  build: { emptyOutDir: false, rollupOptions: { input: 'demo.html' } },
});
