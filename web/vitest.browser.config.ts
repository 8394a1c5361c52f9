import { defineConfig } from 'vitest/config';
import { protocolSource } from './resolve.config';

// One browser at a time: software rendering on two busy cores is slow enough already.
export default defineConfig({
  ...protocolSource,
  test: {
    include: ['tests/browser/**/*.test.ts'],
    environment: 'node',
    fileParallelism: false,
    testTimeout: 600_000,
    hookTimeout: 600_000,
  },
});
